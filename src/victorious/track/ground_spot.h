// track/, a spot of the ground: where it goes in the next frames, whatever stands there or drives away. An object that
// stays on its spot stands still; one that does not moves, which lines of sight alone may not tell.
//
// Points around the spot, not on the object, are followed by Lucas-Kanade from frame to frame; the spot goes as most of
// them do (MLESAC over a similarity): the ground, as far as it is flat about there.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"
#include "victorious/track/flow.h"

namespace victorious {

class GroundSpot {
 public:
  /// The spot in the middle of a box.
  /// @param frame  without salt and pepper, as all others
  GroundSpot(FlowPyramid frame, const Box& object);

  /// The next frame; they come in order of time, or all in reverse.
  /// @param object  where it was in the frame before, if it was seen: no ground
  /// @return where the spot lies, px; nothing from where it was lost on, or has left the frame
  std::optional<Eigen::Vector2d> Step(const FlowPyramid& frame, const std::optional<Box>& object);

 private:
  std::optional<FlowPyramid> before_;  // none: lost
  Eigen::Vector2d place_;
  double side_px_;  // of the object
};

}  // namespace victorious
