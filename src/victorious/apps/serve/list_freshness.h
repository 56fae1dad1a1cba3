// How long the lists of an index (index_view.h) may be given out while they cannot be read again. One rule for all
// requests: for kMaxFailing they get the former lists, then none does. Not thread-safe.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

class ListFreshness {
 public:
  using Clock = std::chrono::steady_clock;

  /// From the first attempt to read that failed.
  static constexpr std::chrono::seconds kMaxFailing{30};
  /// Between two attempts while they fail.
  static constexpr std::chrono::seconds kRetryPause{1};

  /// Whether an attempt is due; always, unless the last one failed just now.
  [[nodiscard]] bool MayTry(Clock::time_point now) const;

  /// The lists are the present ones.
  /// @param begun  of the attempt
  /// @return whether this ends a failure
  bool Succeeded(Clock::time_point begun);

  /// They could not be read.
  /// @return whether it is the first failure after a success
  bool Failed(Error error, Clock::time_point begun, Clock::time_point ended);

  /// How old the lists are; 0 as long as no attempt failed. Error: kUnavailable, with that of the last attempt, if they
  /// are too old to be given out.
  [[nodiscard]] Expected<std::chrono::seconds> Age(Clock::time_point now) const;

 private:
  struct Failure {
    Clock::time_point since;  ///< begin of the first attempt
    Clock::time_point ended;  ///< of the last
    Error error;
  };

  std::optional<Clock::time_point> read_;  ///< when the lists were the present ones
  std::optional<Failure> failure_;
};

}  // namespace victorious
