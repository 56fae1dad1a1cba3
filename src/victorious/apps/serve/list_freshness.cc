#include "victorious/apps/serve/list_freshness.h"

#include <utility>

#include <fmt/format.h>

namespace victorious {

bool ListFreshness::MayTry(Clock::time_point now) const { return !failure_ || now - failure_->ended >= kRetryPause; }

bool ListFreshness::Succeeded(Clock::time_point begun) {
  read_ = begun;
  return std::exchange(failure_, std::nullopt).has_value();
}

bool ListFreshness::Failed(Error error, Clock::time_point begun, Clock::time_point ended) {
  const bool is_first = !failure_;
  failure_ = Failure{.since = is_first ? begun : failure_->since, .ended = ended, .error = std::move(error)};
  return is_first;
}

Expected<std::chrono::seconds> ListFreshness::Age(Clock::time_point now) const {
  using std::chrono::seconds;
  if (!failure_) return seconds(0);
  const auto failing = std::chrono::duration_cast<seconds>(now - failure_->since);
  if (!read_ || failing >= kMaxFailing) {
    return Fail(ErrorCode::kUnavailable, fmt::format("the lists of the index could not be read for {} s: {}",
                                                     failing.count(), failure_->error.message));
  }
  return std::chrono::ceil<seconds>(now - *read_);
}

}  // namespace victorious
