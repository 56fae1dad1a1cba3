#include "experiments/true_matches.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace victorious {
namespace {

// Whether a point is not occluded: in the 3 x 3 pixels around its projection, some surface is not nearer than it.
bool IsVisible(const cv::Mat& depth_m, const Eigen::Vector2d& place, double point_depth_m, double tolerance_m) {
  if (depth_m.empty()) return true;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int column = std::clamp(static_cast<int>(place.x()) + dx, 0, depth_m.cols - 1);
      const int row = std::clamp(static_cast<int>(place.y()) + dy, 0, depth_m.rows - 1);
      const double surface_m = depth_m.at<float>(row, column);
      if (!std::isfinite(surface_m) || surface_m > point_depth_m - tolerance_m) return true;
    }
  }
  return false;
}

}  // namespace

MatchTruth::MatchTruth(const AnnotatedImage& scene, std::string_view kind, std::span<const Point3> points,
                       double size_m)
    : points_(points.size()) {
  for (const LabelledObject& object : scene.objects) {
    if (object.model != kind) continue;
    for (const Point3& point : points) {
      const Eigen::Vector3d in_camera = object.camera_from_model.Apply({point.x, point.y, point.z});
      std::optional<Eigen::Vector2d> place = scene.pinhole.Project(in_camera);
      const bool inside = place && place->x() >= 0 && place->y() >= 0 && place->x() < scene.pinhole.width &&
                          place->y() < scene.pinhole.height;
      if (!inside || !IsVisible(scene.depth_m, *place, in_camera.z(), kSameSurfaceFraction * size_m)) place.reset();
      projections_.push_back(place);
    }
  }
}

MatchLabel MatchTruth::Label(const Keypoint& scene, std::uint32_t model) const {
  double distance_px = std::numeric_limits<double>::infinity();
  for (std::size_t i = model; i < projections_.size(); i += points_) {
    if (projections_[i])
      distance_px = std::min(distance_px, (*projections_[i] - Eigen::Vector2d(scene.x, scene.y)).norm());
  }
  if (distance_px <= std::max(kMinTolerancePx, kToleranceScales * scene.scale_px)) return MatchLabel::kTrue;
  return distance_px <= kNearPx ? MatchLabel::kNear : MatchLabel::kFalse;
}

MatchCount MatchTruth::Count(std::span<const Keypoint> scene, const MatchSet& matches) const {
  MatchCount count{.matches = static_cast<int>(matches.size())};
  for (const Match& match : matches) {
    const MatchLabel truth = Label(scene[match.scene_keypoint], match.template_keypoint);
    count.correct += truth == MatchLabel::kTrue ? 1 : 0;
    count.near += truth == MatchLabel::kNear ? 1 : 0;
  }
  return count;
}

}  // namespace victorious
