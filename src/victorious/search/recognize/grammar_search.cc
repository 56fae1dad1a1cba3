#include "victorious/search/recognize/grammar_search.h"

#include <utility>

namespace victorious {
namespace {

TemplateSet PackViews(const ObjectModel& model) {
  std::vector<FeatureView> views;
  for (std::size_t view = 0; view < model.views.size(); ++view) views.push_back(model.ViewFeatures(view));
  return TemplateSet(views);
}

// @param test_count  number of views searched
void AppendCandidates(const ObjectModel& model, std::size_t view, std::size_t test_count, StagedMatches staged,
                      std::vector<Candidate>& candidates) {
  for (PlanarFit& fit : staged.fits) {
    candidates.push_back({.view = view,
                          .matches = staged.ratio.size(),
                          .views = test_count,
                          .outline = model.views[view].outline,
                          .fit = std::move(fit)});
  }
}

}  // namespace

StagedMatches FilterAndFit(const FeatureSet& scene, const ObjectModel& model, std::size_t view, MatchSet matches,
                           const GrammarSearchOptions& options) {
  const std::span<const Keypoint> template_keypoints = model.ViewFeatures(view).keypoints;
  StagedMatches staged;
  staged.ratio = std::move(matches);
  staged.cascade = FilterByGrammar(scene.keypoints, template_keypoints, staged.ratio, options.cascade);
  staged.fits = EstimatePoses(scene.keypoints, template_keypoints, staged.cascade.third, model.views[view].outline,
                              scene.SearchedBox().Area(), options.pose, model.ViewPoints(view));
  return staged;
}

StagedMatches MatchViewByGrammar(const PreparedScene& scene, const ObjectModel& model, std::size_t view,
                                 const GrammarSearchOptions& options) {
  const FeatureView features = model.ViewFeatures(view);
  std::vector<MatchSet> matches = MatchFeatures(scene.queries(), TemplateSet(std::span(&features, 1)), options.match);
  return FilterAndFit(scene.features(), model, view, std::move(matches.front()), options);
}

GrammarSearch::GrammarSearch(const ObjectModel& model, const GrammarSearchOptions& options)
    : model_(model), options_(options), templates_(PackViews(model)) {}

Expected<std::vector<Candidate>> GrammarSearch::Search(const PreparedScene& scene,
                                                       const FrameConditions& /*conditions*/,
                                                       const ViewPart& part) const {
  if (!part.ContainsWholeModels()) return std::vector<Candidate>();
  std::vector<MatchSet> matches = MatchFeatures(scene.queries(), templates_, options_.match);
  std::vector<Candidate> candidates;
  for (std::size_t view = 0; view < model_.views.size(); ++view) {
    AppendCandidates(model_, view, model_.views.size(),
                     FilterAndFit(scene.features(), model_, view, std::move(matches[view]), options_), candidates);
  }
  return candidates;
}

Expected<std::vector<Candidate>> GrammarSearch::SearchViews(const PreparedScene& scene,
                                                            const FrameConditions& /*conditions*/,
                                                            std::span<const std::size_t> views) const {
  std::vector<Candidate> candidates;
  for (const std::size_t view : views) {
    AppendCandidates(model_, view, views.size(), MatchViewByGrammar(scene, model_, view, options_), candidates);
  }
  return candidates;
}

}  // namespace victorious
