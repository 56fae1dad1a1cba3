#include "victorious/track/ground_point.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "victorious/track/corner_motion.h"

namespace victorious {
namespace {

// Side of the corner region relative to the object's: near enough for the ground to be one plane, and large enough for
// corners outside the object's box.
constexpr double kNeighbourhood = 5;
constexpr double kMinNeighbourhood_px = 120;  // around a small object
constexpr double kCornerNoise_px = 0.7;       // Lucas-Kanade at full resolution

Box SquareAround(const Eigen::Vector2d& centre, double side_px) {
  return {centre.x() - side_px / 2, centre.y() - side_px / 2, side_px, side_px};
}

}  // namespace

GroundPointTracker::GroundPointTracker(FlowPyramid frame, const Box& object)
    : before_(std::move(frame)),
      position_px_(object.x + object.width / 2, object.y + object.height / 2),
      side_px_(std::max(object.width, object.height)) {}

std::optional<Eigen::Vector2d> GroundPointTracker::Step(const FlowPyramid& frame, const std::optional<Box>& object) {
  if (!before_) return std::nullopt;
  const FlowPyramid before = *std::exchange(before_, std::nullopt);
  if (before.grey().size() != frame.grey().size()) return std::nullopt;
  const double side_px = std::max(kNeighbourhood * side_px_, kMinNeighbourhood_px);
  std::vector<Eigen::Vector2d> points = DetectCorners(
      before.grey(),
      BoxCorners(Intersection(SquareAround(position_px_, side_px), FrameBox(frame.grey().cols, frame.grey().rows))),
      kMotionCorners);
  if (object) std::erase_if(points, [&](const auto& point) { return object->Contains(point.x(), point.y()); });
  const auto motion =
      EstimateCornerMotion(before, frame, points, {.noise_px = kCornerNoise_px, .outlier_area_px2 = side_px * side_px});
  if (!motion) return std::nullopt;
  position_px_ = motion->Apply(position_px_);
  if (!FrameBox(frame.grey().cols, frame.grey().rows).Contains(position_px_.x(), position_px_.y())) return std::nullopt;
  before_ = frame;
  return position_px_;
}

}  // namespace victorious
