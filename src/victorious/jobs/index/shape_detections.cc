#include "victorious/jobs/index/shape_detections.h"

#include <algorithm>
#include <functional>
#include <ranges>
#include <utility>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/polygon.h"

namespace victorious {
namespace {

// True if a detection explains what another one rests on: the same model there, or another one with more evidence.
bool Explains(const Detection& a, const Detection& b) {
  constexpr double kMinOverlap = 0.3;
  return IntersectionOverUnion(a.box, b.box) >= kMinOverlap &&
         (a.model_index == b.model_index || a.neg_log10_nfa >= b.neg_log10_nfa);
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
  const std::size_t by_keypoints = detections.size();
  const Box frame = FrameBox(image.cols, image.rows);
  for (const ShapeMatch& match : matches) {
    VICTORIOUS_ASSIGN_OR_RETURN(Detection detection, shapes.MakeDetection(match, features));
    if (FractionInside(detection.outline, frame) < options.min_in_view) continue;
    if (std::min(detection.box.width, detection.box.height) < options.min_side_px) continue;
    const auto is_explained = [&](const Detection& one) { return Explains(one, detection); };
    if (std::ranges::any_of(detections | std::views::take(by_keypoints), is_explained)) continue;
    detections.push_back(std::move(detection));
  }
  std::ranges::stable_sort(detections, std::greater{}, &Detection::score);
  return {};
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
