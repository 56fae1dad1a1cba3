#include "victorious/jobs/index/shape_detections.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/polygon.h"

namespace victorious {
namespace {

// Weaker matches of one frame are not looked for in the frames before.
constexpr double kMinDecadesOfWeak = 1;
// Weak matches are many more than strong ones, and what resembles a vehicle does so in all frames: of these the looks
// together must say more, decades (docs/adr/0050).
constexpr double kMoreOfWeak = 1;
// In one frame, more than what is no vehicle has: in the flights of docs/adr/0050 up to 7.7.
constexpr double kDecadesBeyondDoubt = 8;

// Both cannot stand there, also if one is much smaller.
bool Exclude(const Detection& a, const Detection& b) {
  constexpr double kMinDistance = 0.4;  // over the smaller one's size
  const auto size_px = [](const Box& box) { return std::hypot(box.width, box.height); };
  const double x = a.box.x + a.box.width / 2 - b.box.x - b.box.width / 2;
  const double y = a.box.y + a.box.height / 2 - b.box.y - b.box.height / 2;
  return std::hypot(x, y) < kMinDistance * std::min(size_px(a.box), size_px(b.box));
}

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

Expected<std::vector<ShapeDetection>> FindByShape(const ShapeSearch& shapes, const cv::Mat& image,
                                                  const FrameConditions& conditions, const DetectOptions& options,
                                                  FeatureSet& features) {
  const StageScope scope(Stage::kShape);
  const double min_alone = NegLog10NfaOf(options.min_score);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ShapeMatch> matches,
                              shapes.Find(image, conditions, std::min(kMinDecadesOfWeak, min_alone)));
  std::vector<ShapeMatch> kept;
  std::ranges::copy_if(matches, std::back_inserter(kept),
                       [&](const ShapeMatch& match) { return match.is_examined || match.neg_log10_nfa >= min_alone; });
  std::vector<ShapeDetection> by_shape;
  VICTORIOUS_RETURN_IF_ERROR(AddMatches(shapes, kept, options, features, by_shape));
  return by_shape;
}

Status AddMatches(const ShapeSearch& shapes, std::span<const ShapeMatch> matches, const DetectOptions& options,
                  FeatureSet& features, std::vector<ShapeDetection>& by_shape) {
  const Box frame = FrameBox(features.image_width, features.image_height);
  for (const ShapeMatch& match : matches) {
    VICTORIOUS_ASSIGN_OR_RETURN(Detection detection, shapes.MakeDetection(match, features));
    if (FractionInside(detection.outline, frame) < options.min_in_view) continue;
    if (std::min(detection.box.width, detection.box.height) < options.min_side_px) continue;
    const auto same = std::ranges::find_if(by_shape, [&](const ShapeDetection& other) {
      return other.detection.model_index == detection.model_index && Exclude(other.detection, detection);
    });
    if (same == by_shape.end()) {
      by_shape.push_back({.detection = std::move(detection), .is_examined = match.is_examined, .before = {}});
    } else if (same->detection.neg_log10_nfa < detection.neg_log10_nfa) {
      *same = {.detection = std::move(detection), .is_examined = match.is_examined, .before = {}};
    }
  }
  return {};
}

std::vector<Detection> KeepSignificant(const DetectOptions& options, std::vector<ShapeDetection>& by_shape) {
  const double min_neg_log10_nfa = NegLog10NfaOf(options.min_score);
  const double beyond_doubt = std::max(kDecadesBeyondDoubt, min_neg_log10_nfa);
  const auto by_all = [](const ShapeDetection& one) {
    const double alone = one.detection.neg_log10_nfa;
    return one.before.looks >= kMinLooksBefore ? one.before.NegLog10Nfa(alone) : alone;
  };
  std::ranges::stable_sort(by_shape, std::greater{}, by_all);
  std::vector<ShapeDetection> kept;
  std::vector<Detection> undecided;
  const auto is_free = [&](const Detection& detection) {
    return std::ranges::none_of(kept, [&](const ShapeDetection& other) { return Exclude(other.detection, detection); });
  };
  for (ShapeDetection& one : by_shape) {
    const bool is_decided_before = one.before.looks >= kMinLooksBefore;
    double& evidence = one.detection.neg_log10_nfa;
    if (is_decided_before && evidence < beyond_doubt) {
      const bool is_weak = evidence < min_neg_log10_nfa;
      if (by_all(one) < min_neg_log10_nfa + (is_weak ? kMoreOfWeak : 0)) continue;
      evidence = std::max(evidence, by_all(one));
      one.detection.score = ComputeScore(evidence);
    }
    if (evidence >= min_neg_log10_nfa) {
      if (is_free(one.detection)) kept.push_back(std::move(one));
    } else if (one.is_examined && !is_decided_before && !one.before.is_explained && evidence >= kMinDecadesOfWeak) {
      undecided.push_back(std::move(one.detection));
    }
  }
  std::erase_if(undecided, [&](const Detection& one) { return !is_free(one); });
  by_shape = std::move(kept);
  return undecided;
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
