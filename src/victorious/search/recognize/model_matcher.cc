#include "victorious/search/recognize/model_matcher.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numeric>
#include <ranges>
#include <utility>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/polygon.h"
#include "victorious/search/pose/pose_proposal.h"
#include "victorious/search/pose/vote_poses.h"

namespace victorious {

namespace {

// Ranks of the matches from which the pose of a template is estimated before it votes.
constexpr std::uint32_t kMaxProposalRank = 2;

}  // namespace

std::vector<ScoredVariant> SortedByNfa(std::vector<ScoredVariant> scored) {
  std::ranges::stable_sort(scored, std::greater{}, &ScoredVariant::neg_log10_nfa);
  return scored;
}

ModelMatcher::ModelMatcher(const ObjectModel& model, const RelitTemplateSource* relit_templates,
                           const PreparedScene& scene, const VoteSearchOptions& options,
                           const PoseOptions& pose_options, const std::optional<Vertical>& vertical,
                           std::size_t test_count)
    : model_(model),
      relit_templates_(relit_templates),
      scene_(scene),
      options_(options),
      vertical_(vertical),
      test_count_(test_count),
      matcher_(model, relit_templates, scene, options, pose_options, vertical) {}

void ModelMatcher::Prepare(std::span<const TemplateVariant> variants) const {
  std::vector<RelitTemplateKey> needed;
  for (const TemplateVariant& variant : variants) {
    if (variant.sun_view) needed.push_back({*variant.sun_view, variant.view, variant.half_resolution});
  }
  if (!needed.empty()) relit_templates_->Prepare(needed);
}

Expected<std::vector<double>> ModelMatcher::Evaluate(std::span<const TemplateVariant> variants) {
  Prepare(variants);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<MatchedTemplate> matched, matcher_.Match(variants));
  std::vector<double> neg_log10_nfa;
  for (MatchedTemplate& one : matched) {
    neg_log10_nfa.push_back(Vote(one.variant, one.Compared()));
    matched_.push_back({std::move(one), neg_log10_nfa.back()});
  }
  return neg_log10_nfa;
}

Expected<std::vector<ScoredVariant>> ModelMatcher::EvaluateScored(std::span<const TemplateVariant> variants) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa, Evaluate(variants));
  std::vector<ScoredVariant> scored;
  for (std::size_t i = 0; i < variants.size(); ++i) scored.push_back({variants[i], neg_log10_nfa[i]});
  return scored;
}

Status ModelMatcher::EvaluateBest(std::span<const TemplateVariant> variants, std::size_t max_count) {
  Prepare(variants);
  struct Proposed {
    double neg_log10_nfa;
    std::size_t index;  // in matched_
  };
  std::vector<Proposed> proposed;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<MatchedTemplate> all, matcher_.Match(variants));
  for (MatchedTemplate& matched : all) {
    const StageScope scope(Stage::kPoses);
    const ModelView& view = model_.views[matched.variant.view];
    std::vector<RankedMatch> nearest;
    std::ranges::copy_if(matched.matches, std::back_inserter(nearest),
                         [](const RankedMatch& match) { return match.rank <= kMaxProposalRank; });
    const std::optional<PoseProposal> pose =
        ProposePose(scene_.features(), scene_.density(), matched.features.keypoints, nearest, view.outline, kPi,
                    MakeUprightPrior(view, vertical_, options_));
    if (pose) proposed.push_back({pose->neg_log10_nfa, matched_.size()});
    matched_.push_back({std::move(matched), kNoPose});
  }
  std::ranges::stable_sort(proposed, std::greater{}, &Proposed::neg_log10_nfa);
  for (const Proposed& one : proposed | std::views::take(max_count)) {
    ScoredTemplate& scored = matched_[one.index];
    scored.neg_log10_nfa = Vote(scored.matched.variant, scored.matched.Compared());
  }
  return {};
}

void ModelMatcher::Pool(int max_count) {
  const StageScope scope(Stage::kPoses);
  std::vector<std::size_t> order(matched_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Half resolution is left out: the good ones have been matched at full resolution, too.
  std::erase_if(order, [&](std::size_t i) { return matched_[i].matched.variant.half_resolution; });
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return matched_[i].neg_log10_nfa; });
  for (const std::size_t i : order | std::views::take(max_count)) {
    const auto& [one, neg_log10_nfa] = matched_[i];
    if (neg_log10_nfa == kNoPose) break;
    if (neg_log10_nfa >= kInstanceNegLog10Nfa) continue;  // already certain
    std::vector<ComparedTemplate> beside;
    for (const ScoredTemplate& other : matched_) {
      if (AreNeighbours(one.variant, other.matched.variant)) beside.push_back(other.matched.Compared());
    }
    if (beside.empty() || one.points_in_model.empty()) continue;
    const PooledTemplate pooled = PoolTemplates(one.Compared(), beside);
    Vote(one.variant, {pooled.keypoints, pooled.points_in_model, pooled.matches});
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

// Adds the poses of a template to the candidates; returns their highest -log10 NFA.
double ModelMatcher::Vote(const TemplateVariant& variant, const ComparedTemplate& compared) {
  double max_neg_log10_nfa = kNoPose;
  for (PlanarFit& fit : matcher_.Vote(variant, compared)) {
    max_neg_log10_nfa = std::max(max_neg_log10_nfa, *fit.neg_log10_nfa);
    candidates_.push_back({.view = variant.view,
                           .matches = compared.matches.size(),
                           .views = test_count_,
                           .outline = model_.views[variant.view].outline,
                           .fit = std::move(fit)});
  }
  return max_neg_log10_nfa;
}

bool ModelMatcher::AreNeighbours(const TemplateVariant& one, const TemplateVariant& other) const {
  const std::vector<std::uint32_t>& neighbours = model_.views[one.view].neighbours;
  return one.sun_view.has_value() == other.sun_view.has_value() &&
         one.relative_azimuth_rad == other.relative_azimuth_rad && one.half_resolution == other.half_resolution &&
         std::ranges::find(neighbours, other.view) != neighbours.end();
}

}  // namespace victorious
