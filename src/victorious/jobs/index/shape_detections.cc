#include "victorious/jobs/index/shape_detections.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/polygon.h"

namespace victorious {
namespace {

bool AreInOnePlace(const Detection& a, const Detection& b) {
  constexpr double kMinOverlap = 0.3;
  return IntersectionOverUnion(a.box, b.box) >= kMinOverlap;
}

// True if a detection by keypoints explains what one by shape rests on: one with more evidence, or of the same model,
// unless the shape was examined, too.
bool Explains(const Detection& by_keypoints, const ShapeDetection& by_shape) {
  if (!AreInOnePlace(by_keypoints, by_shape.detection)) return false;
  return by_keypoints.neg_log10_nfa >= by_shape.detection.neg_log10_nfa ||
         (by_keypoints.model_index == by_shape.detection.model_index && !by_shape.is_examined);
}

}  // namespace

double ShapeSearchInterval(const ShapeSearchOptions& options, const FollowOptions& follow, double tracked_rate,
                           double spacing) {
  constexpr double kMargin = 0.8;
  if (!follow.enabled || !(tracked_rate > 0)) return options.interval_s;
  return std::min(spacing * options.interval_s, kMargin * follow.track.unconfirmed_frames / tracked_rate);
}

Status AddShapeDetections(const ShapeSearch& shapes, const cv::Mat& image, const FrameConditions& conditions,
                          const DetectOptions& options, FeatureSet& features, std::vector<Detection>& detections) {
  const StageScope scope(Stage::kShape);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ShapeMatch> matches,
                              shapes.Find(image, conditions, NegLog10NfaOf(options.min_score)));
  const Box frame = FrameBox(image.cols, image.rows);
  std::vector<ShapeDetection> by_shape;
  for (const ShapeMatch& match : matches) {
    VICTORIOUS_ASSIGN_OR_RETURN(Detection detection, shapes.MakeDetection(match, features));
    if (FractionInside(detection.outline, frame) < options.min_in_view) continue;
    if (std::min(detection.box.width, detection.box.height) < options.min_side_px) continue;
    by_shape.push_back({.detection = std::move(detection), .is_examined = match.is_examined});
  }
  JoinDetections(std::move(by_shape), detections);
  return {};
}

void JoinDetections(std::vector<ShapeDetection> by_shape, std::vector<Detection>& detections) {
  std::erase_if(by_shape, [&](const ShapeDetection& one) {
    return std::ranges::any_of(detections, [&](const Detection& other) { return Explains(other, one); });
  });
  std::erase_if(detections, [&](const Detection& by_keypoints) {
    return std::ranges::any_of(by_shape, [&](const ShapeDetection& one) {
      return one.detection.model_index == by_keypoints.model_index && AreInOnePlace(one.detection, by_keypoints);
    });
  });
  for (ShapeDetection& one : by_shape) detections.push_back(std::move(one.detection));
  std::ranges::stable_sort(detections, std::greater{}, &Detection::score);
}

void SetShapeErrors(ObjectPose& object_pose, const ShapeSearchOptions& options) {
  if (object_pose.focal_px > 0) {
    object_pose.sigma_rad = std::max(object_pose.sigma_rad, options.centre_sigma_px / object_pose.focal_px);
  }
  if (object_pose.range_m) {
    object_pose.sigma_range_m =
        std::max(object_pose.sigma_range_m, options.range_sigma_fraction * *object_pose.range_m);
  }
  if (object_pose.view) {
    object_pose.view->sigma_rad = std::max(object_pose.view->sigma_rad, RadiansFromDegrees(options.view_sigma_deg));
  }
}

}  // namespace victorious
