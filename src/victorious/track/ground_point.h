// track/: follows a ground point over the next frames, whether or not an object stands on it. An object that stays on
// its ground point is static; an object that leaves it moves. Bearings alone may not determine which.
//
// Method: corners around the ground point, outside the object's box, are tracked by Lucas-Kanade from frame to frame.
// MLESAC fits a similarity, which moves the point. This assumes that the ground around it is locally flat.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"
#include "victorious/track/flow.h"

namespace victorious {

class GroundPointTracker {
 public:
  /// Starts at the centre of a box.
  /// @param frame   without salt-and-pepper noise, as all frames
  /// @param object  px
  GroundPointTracker(FlowPyramid frame, const Box& object);

  /// Tracks the point into the next frame. Frames are in order of time, or all in reverse order.
  /// @param object  the object's box in the previous frame, px, if seen; corners inside it are not used
  /// @return the point's position, px; std::nullopt once the point is lost or has left the frame, and ever after
  std::optional<Eigen::Vector2d> Step(const FlowPyramid& frame, const std::optional<Box>& object);

 private:
  std::optional<FlowPyramid> before_;  // previous frame; empty: lost
  Eigen::Vector2d position_px_;
  double side_px_;  // longer side of the object's box
};

}  // namespace victorious
