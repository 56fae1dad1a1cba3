#include "victorious/recognize/model_matcher.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <ranges>
#include <utility>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/polygon.h"
#include "victorious/kernels/nearest.h"
#include "victorious/pose/vote_poses.h"

namespace victorious {
namespace {

// Width of an azimuth cell in steps of the sun's azimuth: a cell's lines of sight lie within one step of its centre.
constexpr double kCellWidthSunSteps = 2;

}  // namespace

std::vector<ScoredVariant> SortedByNfa(std::vector<ScoredVariant> scored) {
  std::ranges::stable_sort(scored, std::greater{}, &ScoredVariant::neg_log10_nfa);
  return scored;
}

Eigen::Vector2d ObjectCentre(const PlanarFit& fit, const Polygon& outline) {
  const Box box = BoundingBox(ProjectPolygon(fit.scene_from_template_plane, outline));
  return {box.x + box.width / 2, box.y + box.height / 2};
}

AzimuthCells MakeAzimuthCells(const PreparedScene& scene, const VoteSearchOptions& options,
                              const std::optional<Vertical>& vertical) {
  return {vertical, scene.features().SearchedBox(), kCellWidthSunSteps * options.sun_step_rad};
}

std::optional<UprightPrior> MakeUprightPrior(const ModelView& view, const std::optional<Vertical>& vertical,
                                             const VoteSearchOptions& options) {
  if (!view.angles) return std::nullopt;
  const double off_nadir_rad = view.angles->off_nadir_rad;
  return vertical ? UprightPrior::FromVertical(*vertical, off_nadir_rad, options.max_tilt_rad)
                  : UprightPrior::AssumingUprightCamera(off_nadir_rad, options.max_hanging_rad);
}

ModelMatcher::ModelMatcher(const ObjectModel& model, const RelitTemplateSource* relit_templates,
                           const PreparedScene& scene, const VoteSearchOptions& options,
                           const PoseOptions& pose_options, const std::optional<Vertical>& vertical,
                           std::size_t test_count)
    : model_(model),
      relit_templates_(relit_templates),
      scene_(scene),
      options_(options),
      pose_options_(pose_options),
      vertical_(vertical),
      test_count_(test_count),
      cells_(MakeAzimuthCells(scene, options, vertical)) {}

Expected<std::vector<double>> ModelMatcher::Evaluate(std::span<const TemplateVariant> variants) {
  std::vector<RelitTemplateKey> needed;
  for (const TemplateVariant& variant : variants) {
    if (variant.sun_view) needed.push_back({*variant.sun_view, variant.view, variant.half_resolution});
  }
  if (!needed.empty()) relit_templates_->Prepare(needed);
  std::vector<double> neg_log10_nfa;
  for (const TemplateVariant& variant : variants) {
    VICTORIOUS_ASSIGN_OR_RETURN(const double best, Evaluate(variant));
    neg_log10_nfa.push_back(best);
  }
  return neg_log10_nfa;
}

Expected<std::vector<ScoredVariant>> ModelMatcher::EvaluateScored(std::span<const TemplateVariant> variants) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa, Evaluate(variants));
  std::vector<ScoredVariant> scored;
  for (std::size_t i = 0; i < variants.size(); ++i) scored.push_back({variants[i], neg_log10_nfa[i]});
  return scored;
}

void ModelMatcher::Pool(int max_count) {
  const StageScope scope(Stage::kPoses);
  std::vector<std::size_t> order(matched_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Half resolution is left out: the good ones have been matched at full resolution, too.
  std::erase_if(order, [&](std::size_t i) { return matched_[i].variant.half_resolution; });
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return matched_[i].neg_log10_nfa; });
  for (const std::size_t i : order | std::views::take(max_count)) {
    const MatchedVariant& one = matched_[i];
    if (one.neg_log10_nfa == kNoPose) break;
    if (one.neg_log10_nfa >= kInstanceNegLog10Nfa) continue;  // already certain
    std::vector<ComparedTemplate> beside;
    for (const MatchedVariant& other : matched_) {
      if (AreNeighbours(one.variant, other.variant)) beside.push_back(TemplateOf(other));
    }
    if (beside.empty() || SurfacePointsOf(one).empty()) continue;
    const PooledTemplate pooled = PoolTemplates(TemplateOf(one), beside);
    Vote(one.variant, pooled.keypoints, pooled.points_in_model, pooled.matches);
  }
}

bool ModelMatcher::HasInstancesOutOfViewOnly(double min_in_view) const {
  const Box frame = FrameBox(scene_.features().image_width, scene_.features().image_height);
  bool has_instance = false;
  for (const Candidate& candidate : candidates_) {
    if (*candidate.fit.neg_log10_nfa < kInstanceNegLog10Nfa) continue;
    const Polygon outline = ProjectPolygon(candidate.fit.scene_from_template_plane, candidate.outline);
    if (FractionInside(outline, frame) >= min_in_view) return false;
    has_instance = true;
  }
  return has_instance;
}

Expected<double> ModelMatcher::Evaluate(const TemplateVariant& variant) {
  MatchedVariant matched{.variant = variant, .relit = {}, .matches = {}};
  if (variant.sun_view) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        matched.relit, relit_templates_->GetTemplate({*variant.sun_view, variant.view, variant.half_resolution}));
  }
  const FeatureView features = FeaturesOf(matched);
  matched.matches = Match(features);
  matched.neg_log10_nfa = Vote(variant, features.keypoints, SurfacePointsOf(matched), matched.matches);
  matched_.push_back(std::move(matched));
  return matched_.back().neg_log10_nfa;
}

std::vector<RankedMatch> ModelMatcher::Match(const FeatureView& features) const {
  const StageScope scope(Stage::kMatching);
  return scene_.ranked_matcher().Match(kernels::PackQueries(features.descriptors), options_.nearest);
}

// Adds the poses of a template's keypoints to the candidates; returns their highest -log10 NFA.
double ModelMatcher::Vote(const TemplateVariant& variant, std::span<const Keypoint> keypoints,
                          std::span<const Point3> points, std::span<const RankedMatch> matches) {
  const StageScope scope(Stage::kPoses);
  const ModelView& view = model_.views[variant.view];
  const std::optional<UprightPrior> upright = MakeUprightPrior(view, vertical_, options_);
  double max_neg_log10_nfa = kNoPose;
  for (PlanarFit& fit :
       VotePoses(scene_.features(), keypoints, matches, view.outline, options_.votes, pose_options_, upright, points)) {
    if (!HasSunOfItsCell(variant, fit)) continue;
    max_neg_log10_nfa = std::max(max_neg_log10_nfa, *fit.neg_log10_nfa);
    candidates_.push_back({.view = variant.view,
                           .matches = matches.size(),
                           .views = test_count_,
                           .outline = view.outline,
                           .fit = std::move(fit)});
  }
  return max_neg_log10_nfa;
}

// True if the pose lies in the azimuth cell that the template was relit for: each position has one sun.
bool ModelMatcher::HasSunOfItsCell(const TemplateVariant& variant, const PlanarFit& fit) const {
  if (!variant.relative_azimuth_rad) return true;
  const double relative_azimuth_rad = vertical_->AzimuthAt(ObjectCentre(fit, model_.views[variant.view].outline));
  return cells_.CellCentre(relative_azimuth_rad) == *variant.relative_azimuth_rad;
}

bool ModelMatcher::AreNeighbours(const TemplateVariant& one, const TemplateVariant& other) const {
  const std::vector<std::uint32_t>& neighbours = model_.views[one.view].neighbours;
  return one.sun_view.has_value() == other.sun_view.has_value() &&
         one.relative_azimuth_rad == other.relative_azimuth_rad && one.half_resolution == other.half_resolution &&
         std::ranges::find(neighbours, other.view) != neighbours.end();
}

FeatureView ModelMatcher::FeaturesOf(const MatchedVariant& matched) const {
  return matched.relit ? matched.relit->features.View() : model_.ViewFeatures(matched.variant.view);
}

std::span<const Point3> ModelMatcher::SurfacePointsOf(const MatchedVariant& matched) const {
  if (matched.relit) return matched.relit->points_in_model;
  return model_.ViewPoints(matched.variant.view);
}

ComparedTemplate ModelMatcher::TemplateOf(const MatchedVariant& matched) const {
  return {FeaturesOf(matched).keypoints, SurfacePointsOf(matched), matched.matches};
}

}  // namespace victorious
