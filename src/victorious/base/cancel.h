// A cancellation flag, set by a signal handler or another thread and polled between units of work.
#pragma once

#include <atomic>

namespace victorious {

/// Thread-safe.
class CancelToken {
 public:
  /// Async-signal-safe.
  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool IsCancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

}  // namespace victorious
