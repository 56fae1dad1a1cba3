#include "victorious/track/ground_point.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"

namespace victorious {
namespace {

constexpr double kNeighbourhood = 5;  // side of the corner region relative to the object's
constexpr double kMinNeighbourhood_px = 120;
constexpr int kPoints = 80;
constexpr std::size_t kMinPoints = 12;
constexpr double kNoise_px = 0.7;

Box SquareAround(const Eigen::Vector2d& centre, double side_px) {
  return {centre.x() - side_px / 2, centre.y() - side_px / 2, side_px, side_px};
}

}  // namespace

GroundPointTracker::GroundPointTracker(FlowPyramid frame, const Box& object)
    : before_(std::move(frame)),
      place_(object.x + object.width / 2, object.y + object.height / 2),
      side_px_(std::max(object.width, object.height)) {}

std::optional<Eigen::Vector2d> GroundPointTracker::Step(const FlowPyramid& frame, const std::optional<Box>& object) {
  if (!before_) return std::nullopt;
  const FlowPyramid before = *std::exchange(before_, std::nullopt);
  if (before.grey().size() != frame.grey().size()) return std::nullopt;
  const double side_px = std::max(kNeighbourhood * side_px_, kMinNeighbourhood_px);
  std::vector<Eigen::Vector2d> points = DetectCorners(
      before.grey(),
      BoxCorners(Intersection(SquareAround(place_, side_px), FrameBox(frame.grey().cols, frame.grey().rows))), kPoints);
  if (object) std::erase_if(points, [&](const auto& point) { return object->Contains(point.x(), point.y()); });
  const auto followed = TrackPointsForwardBackward(before, frame, points, points, {});
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (followed[i]) pairs.push_back({points[i], *followed[i]});
  }
  if (pairs.size() < kMinPoints) return std::nullopt;
  const SimilarityEstimator estimator(pairs, {.noise_px = kNoise_px});
  const auto result = Mlesac(estimator, {.outlier_area_px2 = side_px * side_px, .max_hypotheses = 200});
  if (!result || result->gamma * static_cast<double>(pairs.size()) < kMinPoints) return std::nullopt;
  place_ = result->model.Apply(place_);
  if (!FrameBox(frame.grey().cols, frame.grey().rows).Contains(place_.x(), place_.y())) return std::nullopt;
  before_ = frame;
  return place_;
}

}  // namespace victorious
