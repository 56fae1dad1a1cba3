#include "victorious/search/recognize/vote_search.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <ranges>
#include <set>

#include "victorious/search/recognize/model_matcher.h"
#include "victorious/search/recognize/template_variant.h"

namespace victorious {
namespace {

// Coarse views that are also matched relit by the sun: those of the highest -log10 NFA under diffuse light. More than a
// model has, since direct sun may hide all features of diffuse light; bounds the time for a model of very many views.
constexpr int kMaxRelitViews = 1000;

// Of given views, the templates that vote: neighbouring views look alike, and one pose is wanted.
constexpr std::size_t kMaxVotedVariants = 4;

}  // namespace

Expected<std::vector<Candidate>> VoteSearch::Search(const PreparedScene& scene, const FrameConditions& conditions,
                                                    const ViewPart& part) const {
  if (!part.ContainsWholeModels()) return std::vector<Candidate>();
  const bool has_sun = relit_templates_ && conditions.vertical && conditions.relative_sun;
  ModelMatcher matcher(model_, relit_templates_.get(), scene, options_, pose_options_, conditions.vertical,
                       model_.views.size() * (has_sun ? 2 : 1));

  const std::vector<bool> chosen = ChooseViews(model_, matcher.cells(), options_.max_tilt_rad);
  std::set<std::pair<std::size_t, std::optional<double>>>
      matched_cells;  // view and azimuth cell; nullopt: diffuse light
  const auto add_variant = [&](std::size_t view, std::optional<double> relative_azimuth_rad,
                               std::vector<TemplateVariant>& variants) {
    if (!chosen[view] || (relative_azimuth_rad && !HasObservableHeading(model_.views[view]))) return;
    if (!matched_cells.emplace(view, relative_azimuth_rad).second) return;
    variants.push_back(relative_azimuth_rad ? MakeRelitVariant(model_, view, *relative_azimuth_rad,
                                                               *conditions.relative_sun, options_.sun_step_rad)
                                            : TemplateVariant{.view = view, .sun_view = {}});
  };
  std::vector<TemplateVariant> diffuse;
  for (const std::size_t view : ChooseCoarseViews(model_, chosen)) add_variant(view, {}, diffuse);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ScoredVariant> scored, matcher.EvaluateScored(diffuse));
  std::vector<TemplateVariant> relit;
  std::set<std::size_t> relit_views;
  for (const ScoredVariant& scored_variant :
       SortedByNfa(scored)) {  // also those without a pose: direct sun may hide all diffuse features
    const ModelView& view = model_.views[scored_variant.variant.view];
    if (!has_sun || std::ssize(relit_views) == kMaxRelitViews) break;
    if (!HasObservableHeading(view)) continue;
    relit_views.insert(scored_variant.variant.view);
    for (const double relative_azimuth_rad :
         matcher.cells().CellCentresForView(view.angles->off_nadir_rad, options_.max_tilt_rad)) {
      add_variant(scored_variant.variant.view, relative_azimuth_rad, relit);
    }
  }
  for (TemplateVariant& variant : relit) variant.half_resolution = true;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ScoredVariant> scored_relit, matcher.EvaluateScored(relit));
  std::ranges::copy(scored_relit, std::back_inserter(scored));
  std::vector<TemplateVariant> refined_variants;
  for (const ScoredVariant& scored_variant : SortedByNfa(scored) | std::views::take(options_.max_refined_views)) {
    if (scored_variant.neg_log10_nfa == kNoPose) break;
    if (scored_variant.variant.half_resolution) {  // again at full resolution, as its neighbours
      refined_variants.push_back(scored_variant.variant);
      refined_variants.back().half_resolution = false;
    }
    for (const std::uint32_t neighbour : model_.views[scored_variant.variant.view].neighbours) {
      add_variant(neighbour, scored_variant.variant.relative_azimuth_rad, refined_variants);
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(matcher.Evaluate(refined_variants));
  matcher.Pool(kMaxPooledViews);
  return matcher.TakeCandidates();
}

Expected<std::vector<Candidate>> VoteSearch::SearchViews(const PreparedScene& scene, const FrameConditions& conditions,
                                                         std::span<const std::size_t> views) const {
  const bool has_sun = relit_templates_ && conditions.vertical && conditions.relative_sun;
  ModelMatcher matcher(model_, relit_templates_.get(), scene, options_, pose_options_, conditions.vertical,
                       views.size() * (has_sun ? 2 : 1));
  std::vector<TemplateVariant> variants;
  for (const std::size_t number : views) {
    const ModelView& view = model_.views[number];
    if (view.feature_count == 0) continue;
    variants.push_back({.view = number, .sun_view = {}});
    if (!has_sun || !HasObservableHeading(view)) continue;
    for (const double relative_azimuth_rad :
         matcher.cells().CellCentresForView(view.angles->off_nadir_rad, options_.max_tilt_rad)) {
      variants.push_back(
          MakeRelitVariant(model_, number, relative_azimuth_rad, *conditions.relative_sun, options_.sun_step_rad));
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(matcher.EvaluateBest(variants, kMaxVotedVariants));
  matcher.Pool(kMaxPooledViews);
  return matcher.TakeCandidates();
}

}  // namespace victorious
