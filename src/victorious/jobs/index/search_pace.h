// Searches cost most of the time of a pass, those of full frames above all. A pass that has to keep a pace leaves some
// of them out, and tracks only what earlier ones found.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace victorious {

/// Says that a pass could not keep its budget of time a frame.
[[nodiscard]] std::string MissedBudgetText(std::chrono::duration<double> budget, std::chrono::duration<double> mean);

/// Decides whether a frame can be searched in time. Not thread-safe, but for EndFullSearch.
class SearchPace {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param frame_budget  time that the pass may take a frame, on average; std::nullopt: any. A live source, for whose
  ///                      frames the pass waits, has none
  /// @param is_live       the frames come as they are filmed
  explicit SearchPace(std::optional<std::chrono::duration<double>> frame_budget, bool is_live,
                      std::function<Clock::time_point()> now = Clock::now);

  /// True if there is a pace to keep.
  [[nodiscard]] bool IsLimited() const { return is_live_ || frame_budget_; }

  /// Call for each frame that is read, in order. @param behind_s  FrameLoop::ReadBehind; only used of a live source
  void Enter(std::optional<double> behind_s);

  /// True if the regions of tracks in the frame entered last can be searched.
  [[nodiscard]] bool HasTime() const;
  /// True if the whole of it can be searched. Of a live source one frame at a time is: the later ones wait for it.
  [[nodiscard]] bool HasTimeForAll() const { return HasTime() && !(is_live_ && full_searches_ > 0); }

  /// Mean time of a frame until now, if it is more than a tenth above the budget.
  [[nodiscard]] std::optional<std::chrono::duration<double>> MissedBudget() const;

  void BeginFullSearch() { ++full_searches_; }
  void EndFullSearch() { --full_searches_; }

 private:
  std::optional<std::chrono::duration<double>> frame_budget_;
  bool is_live_;
  std::function<Clock::time_point()> now_;
  std::optional<Clock::time_point> start_;
  std::int64_t frames_ = 0;
  std::atomic<int> full_searches_ = 0;
  std::optional<double> behind_s_;
};

}  // namespace victorious
