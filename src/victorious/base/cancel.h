// A cancellation flag, set by a signal handler or another thread and polled between units of work.
#pragma once

#include <atomic>
#include <cstdint>

namespace victorious {

/// Thread-safe.
class CancelToken {
 public:
  /// Async-signal-safe.
  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  /// Cancels at the `polls`-th call of IsCancelled from now. For tests: a job that polls once a frame stops at the same
  /// frame on a machine of any speed.
  void CancelAtPoll(std::int64_t polls) { polls_left_.store(polls, std::memory_order_relaxed); }

  [[nodiscard]] bool IsCancelled() const {
    if (polls_left_.load(std::memory_order_relaxed) > 0 && polls_left_.fetch_sub(1, std::memory_order_relaxed) == 1) {
      cancelled_.store(true, std::memory_order_relaxed);
    }
    return cancelled_.load(std::memory_order_relaxed);
  }

 private:
  mutable std::atomic<bool> cancelled_{false};
  mutable std::atomic<std::int64_t> polls_left_{0};  // 0 or less: not set, or passed
};

}  // namespace victorious
