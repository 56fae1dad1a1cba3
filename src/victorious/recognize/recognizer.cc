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
  fields.AddGroup("likeness", likeness);
}

namespace {

SceneSize SizeOf(const FeatureSet& scene) {
  return {.width_px = static_cast<double>(scene.image_width),
          .height_px = static_cast<double>(scene.image_height),
          .searched_px2 = scene.Searched().Area()};
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

Expected<Recognizer> Recognizer::Create(std::vector<ObjectModel> models, const std::string& engine,
                                        const RecognizeOptions& options,
                                        const std::vector<std::shared_ptr<const LitTemplates>>& lit) {
  VICTORIOUS_CHECK(lit.empty() || lit.size() == models.size());
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.likeness.least_evidence > options.likeness.most_evidence) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("likeness.least_evidence {:g}: must not exceed likeness.most_evidence {:g}; to disable "
                            "rescoring set likeness.most 0",
                            options.likeness.least_evidence, options.likeness.most_evidence));
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckEngine(models, engine));
  return Recognizer(std::move(models), options, lit);
}

Recognizer::Recognizer(std::vector<ObjectModel> models, const RecognizeOptions& options,
                       const std::vector<std::shared_ptr<const LitTemplates>>& lit)
    : models_(std::make_shared<const std::vector<ObjectModel>>(std::move(models))), options_(options) {
  std::vector<FeatureView> templates;
  for (std::size_t m = 0; m < models_->size(); ++m) {
    const ObjectModel& model = (*models_)[m];
    if (IsSearchedByVotes(model, options)) {
      voters_.emplace_back(m, VoteSearch(model, lit.empty() ? nullptr : lit[m]));
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
  staged.poses = EstimatePoses(scene.keypoints, template_keypoints, staged.cascade.third, model.views[ref.view].outline,
                               scene.Searched().Area(), options_.pose);
  return staged;
}

void Recognizer::SearchByGrammar(const FeatureSet& scene, std::vector<Candidate>& candidates) const {
  std::vector<MatchSet> matches = MatchFeatures(scene.View(), templates_, options_.match);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    StagedMatches staged = Filter(scene, views_[i], std::move(matches[i]));
    for (Pose& pose : staged.poses) {
      candidates.push_back({.model = views_[i].model,
                            .view = views_[i].view,
                            .matches = staged.ratio.size(),
                            .views = (*models_)[views_[i].model].views.size(),
                            .outline = (*models_)[views_[i].model].views[views_[i].view].outline,
                            .pose = std::move(pose)});
    }
  }
}

void Recognizer::SearchByVotes(const FeatureSet& scene, const FrameConditions& conditions,
                               std::vector<Candidate>& candidates) const {
  const RankedMatcher ranked(scene.View());
  const VoteScene ready{scene, ranked, options_.search, options_.pose};
  for (const auto& [model, search] : voters_) {
    for (Candidate& candidate : search.Search(ready, conditions)) {
      candidate.model = model;
      candidates.push_back(std::move(candidate));
    }
  }
}

// Rescores the uncertain detections by NCC, in the given order, within the limits per model and per frame; erases those
// below the minimum score.
void Recognizer::WeighByLikeness(const cv::Mat& grey, std::vector<Detection>& detections) const {
  const LikenessOptions& options = options_.likeness;
  cv::Mat scene;
  std::map<std::size_t, int> looks;  // rescored detections by model index
  int in_frame = 0;
  for (Detection& detection : detections) {
    const auto voter = std::ranges::find(voters_, detection.model, &std::pair<std::size_t, VoteSearch>::first);
    if (voter == voters_.end() || voter->second.lit() == nullptr) continue;
    if (detection.evidence < options.least_evidence || detection.evidence > options.most_evidence) continue;
    if (in_frame == options.most_in_frame) break;
    if (looks[detection.model]++ >= options.most) continue;
    ++in_frame;
    if (scene.empty()) scene = SceneForLikeness(grey, options);
    const std::optional<double> sigmas = SigmasOfLikeness(scene, (*models_)[detection.model], *voter->second.lit(),
                                                          detection.view, detection.pose.scene_from_template, options);
    if (!sigmas) continue;
    detection.evidence += options.decades_per_sigma * (*sigmas - options.even_sigmas);
    detection.score = ScoreOf(detection.evidence, options_.detect);
  }
  std::erase_if(detections, [&](const Detection& one) { return one.score < options_.detect.least_score; });
}

std::vector<Detection> Recognizer::Recognize(const FeatureSet& scene, const FrameConditions& conditions,
                                             const cv::Mat& grey) const {
  const SceneSize size = SizeOf(scene);
  std::vector<Candidate> candidates;
  if (!views_.empty()) SearchByGrammar(scene, candidates);
  std::vector<Detection> detections = Detect(candidates, size, options_.detect);
  if (voters_.empty()) return detections;

  candidates.clear();
  SearchByVotes(scene, conditions, candidates);
  DetectOptions doubtful = options_.detect;
  const bool looks = !grey.empty() && options_.likeness.most > 0;
  if (looks) {
    doubtful.least_score = std::min(doubtful.least_score, ScoreOf(options_.likeness.least_evidence, options_.detect));
  }
  std::vector<Detection> voted = Detect(candidates, size, doubtful);
  if (looks) WeighByLikeness(grey, voted);
  detections.insert(detections.end(), voted.begin(), voted.end());
  std::ranges::stable_sort(detections, [](const Detection& a, const Detection& b) {
    return a.score != b.score ? a.score > b.score : a.model < b.model;
  });
  return detections;
}

std::vector<Detection> Recognizer::RecognizeViews(const FeatureSet& scene, std::size_t model,
                                                  std::span<const std::size_t> views,
                                                  const FrameConditions& conditions) const {
  std::vector<Candidate> candidates;
  const auto voter = std::ranges::find(voters_, model, &std::pair<std::size_t, VoteSearch>::first);
  if (voter != voters_.end()) {
    const RankedMatcher ranked(scene.View());
    candidates = voter->second.SearchViews({scene, ranked, options_.search, options_.pose}, conditions, views);
    for (Candidate& candidate : candidates) candidate.model = model;
    return Detect(candidates, SizeOf(scene), options_.detect);
  }
  for (const std::size_t view : views) {
    StagedMatches staged = MatchView(scene, model, view);
    for (Pose& pose : staged.poses) {
      candidates.push_back({.model = model,
                            .view = view,
                            .matches = staged.ratio.size(),
                            .views = views.size(),
                            .outline = (*models_)[model].views[view].outline,
                            .pose = std::move(pose)});
    }
  }
  return Detect(candidates, SizeOf(scene), options_.detect);
}

bool Recognizer::KnowsSuns() const {
  return std::ranges::any_of(voters_, [](const auto& voter) { return voter.second.KnowsSuns(); });
}

std::optional<SunFound> Recognizer::FindSun(const FeatureSet& scene, const Vertical& vertical) const {
  const RankedMatcher ranked(scene.View());
  const VoteScene ready{scene, ranked, options_.search, options_.pose};
  std::vector<std::pair<std::size_t, SunLead>> leads;  // with the index into voters_
  for (std::size_t i = 0; i < voters_.size(); ++i) {
    for (const SunLead& lead : voters_[i].second.FindSunLeads(ready, vertical)) leads.emplace_back(i, lead);
  }
  std::ranges::stable_sort(leads, std::greater{}, [](const auto& lead) { return lead.second.evidence; });
  leads.resize(std::min(leads.size(), static_cast<std::size_t>(options_.search.most_asked)));
  std::optional<SunFound> best;
  for (std::size_t i = 0; i < voters_.size(); ++i) {
    std::vector<SunLead> own;
    for (const auto& [voter, lead] : leads) {
      if (voter == i) own.push_back(lead);
    }
    const std::optional<SunFound> found = voters_[i].second.FindSun(ready, vertical, own);
    if (found && (!best || found->evidence > best->evidence)) best = found;
  }
  return best;
}

StagedMatches Recognizer::MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const {
  const FeatureView features = (*models_)[model].ViewFeatures(view);
  std::vector<MatchSet> matches = MatchFeatures(scene.View(), TemplateSet(std::span(&features, 1)), options_.match);
  return Filter(scene, {model, view}, std::move(matches.front()));
}

}  // namespace victorious
