// One frame an interval of a pass: those that keep their features for the search by image, and those searched by shape.
#pragma once

#include <cmath>
#include <utility>

namespace victorious {

/// Selects one frame per interval, counted from the beginning of the video: the same frames after any interruption.
class IntervalSelector {
 public:
  /// @param interval_s  0: all frames; negative: none
  explicit IntervalSelector(double interval_s) : interval_s_(interval_s) {}

  /// Call in the order of frames.
  [[nodiscard]] bool IsSelected(double time_s) {
    if (interval_s_ < 0) return false;
    if (interval_s_ == 0) return true;
    const double slot = std::floor(time_s / interval_s_ + 1e-9);
    return std::exchange(last_slot_, slot) != slot;
  }

 private:
  double interval_s_;
  double last_slot_ = -1;
};

}  // namespace victorious
