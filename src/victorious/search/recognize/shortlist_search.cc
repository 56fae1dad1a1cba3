#include "victorious/search/recognize/shortlist_search.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <ranges>

#include "victorious/search/recognize/model_matcher.h"
#include "victorious/search/recognize/template_proposals.h"
#include "victorious/search/recognize/template_variant.h"

namespace victorious {
namespace {

// Step of the sun's azimuth of coarse views, in steps of that of refined ones: each new sun needs new templates of all
// coarse views.
constexpr double kCoarseSunSteps = 2;

bool IsSameTemplate(const TemplateVariant& a, const TemplateVariant& b) {
  return a.view == b.view && a.relative_azimuth_rad == b.relative_azimuth_rad && a.half_resolution == b.half_resolution;
}

void AddMissing(const TemplateVariant& variant, std::span<const TemplateVariant> known,
                std::vector<TemplateVariant>& variants) {
  const auto is_it = [&](const TemplateVariant& other) { return IsSameTemplate(variant, other); };
  if (std::ranges::none_of(known, is_it) && std::ranges::none_of(variants, is_it)) variants.push_back(variant);
}

}  // namespace

Expected<std::vector<Candidate>> ShortlistSearch::Search(const PreparedScene& scene, const FrameConditions& conditions,
                                                         const ViewPart& part) const {
  const bool has_sun = relit_templates_ && conditions.vertical && conditions.relative_sun;
  ModelMatcher matcher(model_, relit_templates_.get(), scene, options_, pose_options_, conditions.vertical,
                       model_.views.size() * (has_sun ? 2 : 1));
  const std::vector<bool> chosen = ChooseViews(model_, matcher.cells(), options_.max_tilt_rad);
  const auto propose = [&](std::span<const TemplateVariant> variants) {
    return ProposeTemplates(*shortened_, relit_templates_.get(), scene, matcher.cells(), options_, variants,
                            shortlist_.nearest);
  };
  const auto with_light_of = [&](const TemplateVariant& one, std::size_t view) {
    return one.relative_azimuth_rad ? MakeRelitVariant(model_, view, *one.relative_azimuth_rad,
                                                       *conditions.relative_sun, options_.sun_step_rad)
                                    : TemplateVariant{.view = view, .sun_view = {}};
  };
  // The neighbours of a template in the same light, which are not yet in `known`.
  const auto add_neighbours = [&](const TemplateVariant& one, std::span<const TemplateVariant> known,
                                  std::vector<TemplateVariant>& variants) {
    for (const std::uint32_t neighbour : model_.views[one.view].neighbours) {
      if (!chosen[neighbour] || (one.relative_azimuth_rad && !HasObservableHeading(model_.views[neighbour]))) continue;
      AddMissing(with_light_of(one, neighbour), known, variants);
    }
  };

  std::vector<TemplateVariant> coarse;
  const std::vector<std::size_t> coarse_views = ChooseCoarseViews(model_, chosen);
  for (std::size_t i = 0; i < coarse_views.size(); ++i) {
    if (!part.Contains(i)) continue;
    const std::size_t view = coarse_views[i];
    coarse.push_back({.view = view, .sun_view = {}});
    if (!has_sun || !HasObservableHeading(model_.views[view])) continue;
    for (const double relative_azimuth_rad :
         matcher.cells().CellCentresForView(model_.views[view].angles->off_nadir_rad, options_.max_tilt_rad)) {
      coarse.push_back(MakeRelitVariant(model_, view, relative_azimuth_rad, *conditions.relative_sun,
                                        kCoarseSunSteps * options_.sun_step_rad));
      coarse.back().half_resolution = true;
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TemplateProposal> proposals, propose(coarse));

  std::vector<TemplateVariant> refined;
  for (const TemplateProposal& one : BestProposals(proposals, {shortlist_.max_refined, shortlist_.max_refined_per_place,
                                                               shortlist_.min_refined_neg_log10_nfa})) {
    if (one.variant.half_resolution) AddMissing(with_light_of(one.variant, one.variant.view), {}, refined);
    add_neighbours(one.variant, coarse, refined);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TemplateProposal> of_refined, propose(refined));
  std::ranges::move(of_refined, std::back_inserter(proposals));

  std::vector<TemplateVariant> verified;
  std::vector<ScoredVariant> scored;
  for (int round = 1; round <= shortlist_.max_rounds; ++round) {
    const int max_count = round * shortlist_.max_verified;
    std::vector<TemplateVariant> next;
    for (const TemplateProposal& one :
         BestProposals(proposals, {max_count, round == 1 ? shortlist_.max_verified_per_place : max_count,
                                   shortlist_.min_verified_neg_log10_nfa})) {
      AddMissing(one.variant, verified, next);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ScoredVariant> of_round, matcher.EvaluateScored(next));
    std::ranges::copy(of_round, std::back_inserter(scored));
    std::ranges::copy(next, std::back_inserter(verified));
    // At the frame's border neighbouring views disagree about the part outside: another one may fit.
    if (!matcher.HasInstancesOutOfViewOnly(shortlist_.min_in_view)) break;
  }
  std::vector<TemplateVariant> beside;
  for (const ScoredVariant& one : SortedByNfa(scored) | std::views::take(shortlist_.max_pooled)) {
    if (one.neg_log10_nfa < shortlist_.min_pooled_neg_log10_nfa) break;
    if (one.neg_log10_nfa < kInstanceNegLog10Nfa) add_neighbours(one.variant, verified, beside);
  }
  VICTORIOUS_RETURN_IF_ERROR(matcher.Evaluate(beside));
  matcher.Pool(kMaxPooledViews);
  return matcher.TakeCandidates();
}

}  // namespace victorious
