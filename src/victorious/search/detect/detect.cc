#include "victorious/search/detect/detect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "victorious/base/binomial.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/robust/similarity_estimator.h"

namespace victorious {

void DetectOptions::ListFields(FieldList& fields) {
  fields.Add("min_score", min_score,
             {.min = 0,
              .max = 1,
              .reason = "minimum score of a detection; the default is the score of -log10 NFA = 4 decades"});
  fields.Add("min_side_px", min_side_px,
             {.min = 0,
              .max = 10000,
              .unit = "px",
              .reason = "minimum of the width and height of a detection's box in the frame"});
}

namespace {

// p: the chance that a false match agrees with a pose within a radius, and in rotation and scale.
double AgreementChance(double radius_px, const SceneSize& scene) {
  const double area_px2 = scene.searched_px2.value_or(scene.width_px * scene.height_px);
  return std::min(1.0, kPi * radius_px * radius_px / std::max(1.0, area_px2)) * kAgreementRotationScaleProbability;
}

// -log10 NFA, maximised over the radius and corrected for the number of radii; at least 0. Each residual is a candidate
// radius, at least sigma_px: a photo seen obliquely deviates from a similarity by more than the keypoint noise.
double MaxNegLog10Nfa(const Candidate& candidate, const SceneSize& scene) {
  const std::vector<double>& off_px = candidate.fit.agreeing_residuals_px;
  constexpr std::size_t kMinAgreeing = 3;
  if (off_px.size() < kMinAgreeing) return 0;
  double highest = 0;
  for (std::size_t k = kMinAgreeing; k <= off_px.size(); ++k) {
    const double chance = AgreementChance(std::max(candidate.fit.sigma_px, off_px[k - 1]), scene);
    highest = std::max(highest, ComputeNegLog10Nfa(candidate.matches, k, chance, candidate.views));
  }
  return std::max(0.0, highest - std::log10(static_cast<double>(off_px.size() - kMinAgreeing + 1)));
}

// The image region of a detection, for suppression.
struct ImageArea {
  Polygon hull;
  Eigen::Vector2d centre;
  double size_px;  // square root of the outline's area
};

ImageArea MakeFootprint(const Polygon& outline) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : outline) centre += corner / static_cast<double>(outline.size());
  return {ConvexHull(outline), centre, std::sqrt(std::abs(SignedArea(outline)))};
}

// True if two detections are the same instance: their centres lie close together, or their hulls overlap.
bool IsSameInstance(const ImageArea& a, const ImageArea& b, const DetectOptions& options) {
  if ((a.centre - b.centre).norm() < options.suppression_fraction * std::min(a.size_px, b.size_px)) return true;
  const double common = std::abs(SignedArea(ClipToConvex(a.hull, b.hull)));
  const double smaller = std::min(std::abs(SignedArea(a.hull)), std::abs(SignedArea(b.hull)));
  return common > kSuppressionOverlap * smaller;
}

Detection MakeDetection(const Candidate& candidate, const SceneSize& scene) {
  Detection detection{.model_index = candidate.model_index, .view = candidate.view, .fit = candidate.fit};
  detection.outline = ProjectPolygon(candidate.fit.scene_from_template_plane, candidate.outline);
  detection.box = BoundingBox(ClipToBox(detection.outline, FrameBox(scene.width_px, scene.height_px)));
  detection.neg_log10_nfa =
      candidate.fit.neg_log10_nfa
          ? *candidate.fit.neg_log10_nfa - std::log10(static_cast<double>(std::max<std::size_t>(1, candidate.views)))
          : MaxNegLog10Nfa(candidate, scene);
  detection.score = ComputeScore(detection.neg_log10_nfa);
  return detection;
}

}  // namespace

double ComputeScore(double neg_log10_nfa) {
  return 1 / (1 + std::exp(-(neg_log10_nfa - kScoreMidpoint) / kScoreScale));
}

double NegLog10NfaOf(double score) { return kScoreMidpoint + kScoreScale * std::log(score / (1 - score)); }

double ComputeNegLog10Nfa(std::size_t matches, std::size_t agreeing, double chance, std::size_t views) {
  if (agreeing < 3 || matches < agreeing) return 0;
  if (!(chance < 1)) return 0;
  const double n = static_cast<double>(matches) - 2;
  const double k = static_cast<double>(agreeing) - 2;
  if (k <= n * chance) return 0;
  const double first_term = LogChoose(n, k) + k * std::log(chance) + (n - k) * std::log1p(-chance);
  // Beyond the mean the terms fall at least geometrically, so the tail is at most first_term / (1 - ratio).
  const double ratio = (n - k) / (k + 1) * chance / (1 - chance);
  const double log_tail = first_term - std::log1p(-std::min(ratio, 0.999));
  const double log_tests =
      std::log(static_cast<double>(std::max<std::size_t>(1, views))) + LogChoose(static_cast<double>(matches), 2);
  return -(log_tests + log_tail) / std::log(10.0);
}

std::vector<Detection> Detect(std::span<const Candidate> candidates, const SceneSize& scene,
                              const DetectOptions& options) {
  std::vector<Detection> detections;
  for (const Candidate& candidate : candidates) {
    Detection detection = MakeDetection(candidate, scene);
    const bool large_enough = std::min(detection.box.width, detection.box.height) >= options.min_side_px;
    const bool in_view =
        FractionInside(detection.outline, FrameBox(scene.width_px, scene.height_px)) >= options.min_in_view;
    const bool wide_enough = detection.fit.extent >= options.min_extent;
    if (large_enough && in_view && wide_enough && detection.score >= options.min_score) {
      detections.push_back(std::move(detection));
    }
  }
  std::ranges::stable_sort(detections, [](const Detection& a, const Detection& b) {
    if (a.model_index != b.model_index)
      return a.model_index < b.model_index;  // the NFA is not comparable across models
    return a.neg_log10_nfa > b.neg_log10_nfa;
  });

  std::vector<Detection> kept;
  std::map<std::size_t, std::vector<ImageArea>> taken;  // by model
  for (Detection& detection : detections) {
    const ImageArea footprint = MakeFootprint(detection.outline);
    std::vector<ImageArea>& others = taken[detection.model_index];
    const bool suppressed =
        std::ranges::any_of(others, [&](const ImageArea& other) { return IsSameInstance(footprint, other, options); });
    if (suppressed) continue;
    others.push_back(footprint);
    kept.push_back(std::move(detection));
  }
  std::ranges::stable_sort(kept, std::greater{}, &Detection::score);
  return kept;
}

}  // namespace victorious
