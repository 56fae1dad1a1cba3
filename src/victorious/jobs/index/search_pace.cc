#include "victorious/jobs/index/search_pace.h"

#include <utility>

#include <fmt/format.h>

namespace victorious {

std::string MissedBudgetText(std::chrono::duration<double> budget, std::chrono::duration<double> mean) {
  constexpr double kMsPerS = 1e3;
  return fmt::format(
      "a frame took {:.3g} ms on average, more than the budget of {:.3g} ms: reading, the first frame's search and "
      "tracking are never left out",
      kMsPerS * mean.count(), kMsPerS * budget.count());
}

namespace {

// A search of a live source's frame takes some tenths of a second, and the results of the frames after it wait for it:
// none begins while earlier frames wait.
constexpr double kMaxBehind_s = 0.1;

}  // namespace

SearchPace::SearchPace(std::optional<std::chrono::duration<double>> frame_budget, bool is_live,
                       std::function<Clock::time_point()> now)
    : frame_budget_(is_live ? std::nullopt : frame_budget), is_live_(is_live), now_(std::move(now)) {}

void SearchPace::Enter(std::optional<double> behind_s) {
  if (!start_) start_ = now_();
  ++frames_;
  behind_s_ = behind_s;
}

bool SearchPace::HasTime() const {
  if (is_live_ && (!behind_s_ || *behind_s_ > kMaxBehind_s)) return false;
  return !frame_budget_ || now_() - *start_ <= *frame_budget_ * static_cast<double>(frames_);
}

std::optional<std::chrono::duration<double>> SearchPace::MissedBudget() const {
  constexpr double kAllowance = 1.1;  // the last search begins before the budget is spent, and ends after it
  if (!frame_budget_ || frames_ == 0) return std::nullopt;
  const std::chrono::duration<double> mean = (now_() - *start_) / static_cast<double>(frames_);
  return mean > kAllowance * *frame_budget_ ? std::optional(mean) : std::nullopt;
}

}  // namespace victorious
