// When the worker of a leased task renews its lease, and when it must stop. The time of this machine decides, so that a
// worker also stops whose queue does not answer: once the lease has run out, another worker has the task, and two must
// not write the same results.
#pragma once

#include <chrono>

#include "victorious/base/error.h"

namespace victorious {

class LeaseClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param lease     how long a lease lasts from its last renewal
  /// @param interval  between attempts to renew it; several fit into a lease
  /// @param claimed   before the task was claimed, or later by much less than `lease`
  LeaseClock(Clock::duration lease, Clock::duration interval, Clock::time_point claimed)
      : lease_(lease), interval_(interval), asked_(claimed), renewed_(claimed) {}

  [[nodiscard]] bool IsDue(Clock::time_point now) const { return !is_lost_ && now - asked_ >= interval_; }

  /// Enters how an attempt ended.
  /// @param asked  before the queue was asked: it has prolonged the lease then or later
  void Enter(const Status& renewal, Clock::time_point asked) {
    asked_ = asked;
    if (renewal) renewed_ = asked;
    is_lost_ |= !renewal && renewal.error().code == ErrorCode::kConflict;
  }

  /// Whether the lease is lost at `now`: the queue said so, or the last renewal is older than a lease. A lost lease
  /// stays lost.
  [[nodiscard]] bool IsLost(Clock::time_point now) {
    is_lost_ |= now - renewed_ >= lease_;
    return is_lost_;
  }

  /// What IsLost() returned last.
  [[nodiscard]] bool was_lost() const { return is_lost_; }

 private:
  Clock::duration lease_;
  Clock::duration interval_;
  Clock::time_point asked_;
  Clock::time_point renewed_;
  bool is_lost_ = false;
};

}  // namespace victorious
