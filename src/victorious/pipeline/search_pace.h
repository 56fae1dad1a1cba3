// Full-frame searches cost most of the time of a pass. A pass that has to keep a pace leaves some of them out, and tracks
// only what earlier ones found.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

namespace victorious {

/// Decides whether a frame that is due for a full-frame search can be searched in time. Not thread-safe.
class SearchPace {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param frame_budget  time that the pass may take a frame, on average; std::nullopt: any
  /// @param is_live       the frames come as they are filmed
  explicit SearchPace(std::optional<std::chrono::duration<double>> frame_budget, bool is_live,
                      std::function<Clock::time_point()> now = Clock::now);

  /// Call for each frame that is read, in order. @param behind_s  FrameLoop::BehindOf; only used of a live source
  void Enter(double behind_s);

  /// True if a full-frame search of the frame entered last keeps the pace.
  [[nodiscard]] bool HasTime() const;

 private:
  std::optional<std::chrono::duration<double>> frame_budget_;
  bool is_live_;
  std::function<Clock::time_point()> now_;
  std::optional<Clock::time_point> start_;
  std::int64_t frames_ = 0;
  double behind_s_ = 0;
};

}  // namespace victorious
