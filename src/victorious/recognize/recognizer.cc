#include "victorious/recognize/recognizer.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/check.h"

namespace victorious {

void RecognizeOptions::ListFields(FieldList& fields) {
  fields.Add("method", method,
             {.choices = {"auto", "grammar", "votes"},
              .reason = "pose estimation from matches: grammar, the thesis's ratio test, cascade and MLESAC; votes, "
                        "Hough voting of ranked matches; auto, votes for CAD models and the grammar for photos"});
  fields.AddGroup("search", search);
  fields.AddGroup("match", match);
  fields.AddGroup("cascade", cascade);
  fields.AddGroup("pose", pose);
  fields.AddGroup("detect", detect);
  fields.AddGroup("ncc", ncc);
}

namespace {

SceneSize MakeSceneSize(const FeatureSet& scene) {
  return {.width_px = static_cast<double>(scene.image_width),
          .height_px = static_cast<double>(scene.image_height),
          .searched_px2 = scene.SearchedBox().Area()};
}

bool IsSearchedByVotes(const ObjectModel& model, const RecognizeOptions& options) {
  return options.method == "votes" || (options.method == "auto" && model.kind == "cad");
}

}  // namespace

Status CheckEngine(std::span<const ObjectModel> models, std::string_view engine) {
  for (const ObjectModel& model : models) {
    if (model.engine == engine) continue;
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("model {}: features of engine {}, but the search uses {}: make the model again with that engine",
                    model.name, model.engine, engine));
  }
  return {};
}

Expected<Recognizer> Recognizer::Create(
    std::vector<ObjectModel> models, const std::string& engine, const RecognizeOptions& options,
    const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates) {
  VICTORIOUS_CHECK(relit_templates.empty() || relit_templates.size() == models.size());
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.ncc.min_neg_log10_nfa > options.ncc.max_neg_log10_nfa) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("ncc.min_neg_log10_nfa {:g}: must not exceed ncc.max_neg_log10_nfa {:g}; to disable "
                            "rescoring set ncc.max_poses 0",
                            options.ncc.min_neg_log10_nfa, options.ncc.max_neg_log10_nfa));
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckEngine(models, engine));
  return Recognizer(std::move(models), options, relit_templates);
}

Recognizer::Recognizer(std::vector<ObjectModel> models, const RecognizeOptions& options,
                       const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates)
    : models_(std::make_shared<const std::vector<ObjectModel>>(std::move(models))), options_(options) {
  std::vector<FeatureView> templates;
  for (std::size_t m = 0; m < models_->size(); ++m) {
    const ObjectModel& model = (*models_)[m];
    if (IsSearchedByVotes(model, options)) {
      vote_searches_.emplace_back(m, VoteSearch(model, relit_templates.empty() ? nullptr : relit_templates[m]));
      continue;
    }
    for (std::size_t v = 0; v < model.views.size(); ++v) {
      views_.push_back({m, v});
      templates.push_back(model.ViewFeatures(v));
    }
  }
  templates_ = TemplateSet(templates);
}

StagedMatches Recognizer::Filter(const FeatureSet& scene, const ViewRef& ref, MatchSet matches) const {
  const ObjectModel& model = (*models_)[ref.model];
  const std::span<const Keypoint> template_keypoints = model.ViewFeatures(ref.view).keypoints;
  StagedMatches staged;
  staged.ratio = std::move(matches);
  staged.cascade = FilterByGrammar(scene.keypoints, template_keypoints, staged.ratio, options_.cascade);
  staged.fits = EstimatePoses(scene.keypoints, template_keypoints, staged.cascade.third, model.views[ref.view].outline,
                              scene.SearchedBox().Area(), options_.pose);
  return staged;
}

void Recognizer::SearchByGrammar(const FeatureSet& scene, std::vector<Candidate>& candidates) const {
  std::vector<MatchSet> matches = MatchFeatures(scene.View(), templates_, options_.match);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    StagedMatches staged = Filter(scene, views_[i], std::move(matches[i]));
    for (PlanarFit& fit : staged.fits) {
      candidates.push_back({.model_index = views_[i].model,
                            .view = views_[i].view,
                            .matches = staged.ratio.size(),
                            .views = (*models_)[views_[i].model].views.size(),
                            .outline = (*models_)[views_[i].model].views[views_[i].view].outline,
                            .fit = std::move(fit)});
    }
  }
}

void Recognizer::SearchByVotes(const FeatureSet& scene, const FrameConditions& conditions,
                               std::vector<Candidate>& candidates) const {
  const RankedMatcher ranked(scene.View());
  const PreparedScene ready{scene, ranked, options_.search, options_.pose};
  for (const auto& [model, search] : vote_searches_) {
    for (Candidate& candidate : search.Search(ready, conditions)) {
      candidate.model_index = model;
      candidates.push_back(std::move(candidate));
    }
  }
}

// Rescores the uncertain detections by NCC, in the given order, within the limits per model and per frame; erases those
// below the minimum score.
void Recognizer::RescoreByNcc(const cv::Mat& grey, std::vector<Detection>& detections) const {
  const NccOptions& options = options_.ncc;
  cv::Mat scene;
  std::map<std::size_t, int> rescores;  // rescored detections by model index
  int in_frame = 0;
  for (Detection& detection : detections) {
    const auto vote_search =
        std::ranges::find(vote_searches_, detection.model_index, &std::pair<std::size_t, VoteSearch>::first);
    if (vote_search == vote_searches_.end() || vote_search->second.relit_templates() == nullptr) continue;
    if (detection.neg_log10_nfa < options.min_neg_log10_nfa || detection.neg_log10_nfa > options.max_neg_log10_nfa)
      continue;
    if (in_frame == options.max_poses_per_frame) break;
    if (rescores[detection.model_index]++ >= options.max_poses) continue;
    ++in_frame;
    if (scene.empty()) scene = PrepareSceneForNcc(grey, options);
    const std::optional<double> sigmas =
        ComputeNccZScore(scene, (*models_)[detection.model_index], *vote_search->second.relit_templates(),
                         detection.view, detection.fit.scene_from_template, options);
    if (!sigmas) continue;
    detection.neg_log10_nfa += options.decades_per_z_score * (*sigmas - options.neutral_z_score);
    detection.score = ComputeScore(detection.neg_log10_nfa, options_.detect);
  }
  std::erase_if(detections, [&](const Detection& one) { return one.score < options_.detect.min_score; });
}

std::vector<Detection> Recognizer::Recognize(const FeatureSet& scene, const FrameConditions& conditions,
                                             const cv::Mat& grey) const {
  const SceneSize size = MakeSceneSize(scene);
  std::vector<Candidate> candidates;
  if (!views_.empty()) SearchByGrammar(scene, candidates);
  std::vector<Detection> detections = Detect(candidates, size, options_.detect);
  if (vote_searches_.empty()) return detections;

  candidates.clear();
  SearchByVotes(scene, conditions, candidates);
  DetectOptions doubtful = options_.detect;
  const bool rescores = !grey.empty() && options_.ncc.max_poses > 0;
  if (rescores) {
    doubtful.min_score = std::min(doubtful.min_score, ComputeScore(options_.ncc.min_neg_log10_nfa, options_.detect));
  }
  std::vector<Detection> voted = Detect(candidates, size, doubtful);
  if (rescores) RescoreByNcc(grey, voted);
  detections.insert(detections.end(), voted.begin(), voted.end());
  std::ranges::stable_sort(detections, [](const Detection& a, const Detection& b) {
    return a.score != b.score ? a.score > b.score : a.model_index < b.model_index;
  });
  return detections;
}

std::vector<Detection> Recognizer::RecognizeViews(const FeatureSet& scene, std::size_t model,
                                                  std::span<const std::size_t> views,
                                                  const FrameConditions& conditions) const {
  std::vector<Candidate> candidates;
  const auto vote_search = std::ranges::find(vote_searches_, model, &std::pair<std::size_t, VoteSearch>::first);
  if (vote_search != vote_searches_.end()) {
    const RankedMatcher ranked(scene.View());
    candidates = vote_search->second.SearchViews({scene, ranked, options_.search, options_.pose}, conditions, views);
    for (Candidate& candidate : candidates) candidate.model_index = model;
    return Detect(candidates, MakeSceneSize(scene), options_.detect);
  }
  for (const std::size_t view : views) {
    StagedMatches staged = MatchView(scene, model, view);
    for (PlanarFit& fit : staged.fits) {
      candidates.push_back({.model_index = model,
                            .view = view,
                            .matches = staged.ratio.size(),
                            .views = views.size(),
                            .outline = (*models_)[model].views[view].outline,
                            .fit = std::move(fit)});
    }
  }
  return Detect(candidates, MakeSceneSize(scene), options_.detect);
}

bool Recognizer::HasRelitTemplates() const {
  return std::ranges::any_of(vote_searches_,
                             [](const auto& vote_search) { return vote_search.second.HasRelitTemplates(); });
}

std::optional<SunEstimate> Recognizer::EstimateSun(const FeatureSet& scene, const Vertical& vertical) const {
  const RankedMatcher ranked(scene.View());
  const PreparedScene ready{scene, ranked, options_.search, options_.pose};
  std::vector<std::pair<std::size_t, SunCandidateView>> sun_candidates;  // with the index into vote_searches_
  for (std::size_t i = 0; i < vote_searches_.size(); ++i) {
    for (const SunCandidateView& sun_candidate : vote_searches_[i].second.FindSunCandidateViews(ready, vertical))
      sun_candidates.emplace_back(i, sun_candidate);
  }
  std::ranges::stable_sort(sun_candidates, std::greater{},
                           [](const auto& sun_candidate) { return sun_candidate.second.neg_log10_nfa; });
  sun_candidates.resize(std::min(sun_candidates.size(), static_cast<std::size_t>(options_.search.max_sun_views)));
  std::optional<SunEstimate> best;
  for (std::size_t i = 0; i < vote_searches_.size(); ++i) {
    std::vector<SunCandidateView> own;
    for (const auto& [vote_search, sun_candidate] : sun_candidates) {
      if (vote_search == i) own.push_back(sun_candidate);
    }
    const std::optional<SunEstimate> found = vote_searches_[i].second.EstimateSun(ready, vertical, own);
    if (found && (!best || found->neg_log10_nfa > best->neg_log10_nfa)) best = found;
  }
  return best;
}

StagedMatches Recognizer::MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const {
  const FeatureView features = (*models_)[model].ViewFeatures(view);
  std::vector<MatchSet> matches = MatchFeatures(scene.View(), TemplateSet(std::span(&features, 1)), options_.match);
  return Filter(scene, {model, view}, std::move(matches.front()));
}

}  // namespace victorious
