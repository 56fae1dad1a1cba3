#include "victorious/search/recognize/recognizer.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "victorious/base/check.h"
#include "victorious/base/stage_time.h"

namespace victorious {

namespace {

SceneSize MakeSceneSize(const FeatureSet& scene) {
  return {.width_px = static_cast<double>(scene.image_width),
          .height_px = static_cast<double>(scene.image_height),
          .searched_px2 = scene.SearchedBox().Area()};
}

std::vector<Detection> DetectIn(const FeatureSet& scene, std::span<const Candidate> candidates,
                                const DetectOptions& options) {
  const StageScope scope(Stage::kDetection);
  return Detect(candidates, MakeSceneSize(scene), options);
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
                                        const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates,
                                        std::shared_ptr<kernels::NearestDevice> device) {
  return Create(std::make_shared<const std::vector<ObjectModel>>(std::move(models)), engine, options, relit_templates,
                std::move(device));
}

Expected<Recognizer> Recognizer::Create(std::shared_ptr<const std::vector<ObjectModel>> models,
                                        const std::string& engine, const RecognizeOptions& options,
                                        const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates,
                                        std::shared_ptr<kernels::NearestDevice> device) {
  VICTORIOUS_CHECK(relit_templates.empty() || relit_templates.size() == models->size());
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_CHECK(options.ncc.min_neg_log10_nfa <= options.ncc.max_neg_log10_nfa);
  VICTORIOUS_RETURN_IF_ERROR(CheckEngine(*models, engine));
  return Recognizer(std::move(models), options, relit_templates, std::move(device));
}

Recognizer::Recognizer(std::shared_ptr<const std::vector<ObjectModel>> models, const RecognizeOptions& options,
                       const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates,
                       std::shared_ptr<kernels::NearestDevice> device)
    : models_(std::move(models)), relit_templates_(relit_templates), options_(options), device_(std::move(device)) {
  for (std::size_t m = 0; m < models_->size(); ++m) {
    shortened_.push_back(std::make_shared<const ShortenedViews>((*models_)[m]));
    searchers_.push_back(MakeModelSearcher((*models_)[m], shortened_.back(),
                                           relit_templates.empty() ? nullptr : relit_templates[m], options));
  }
}

// Rescores the uncertain detections by NCC, in the given order, within the limits per model and per frame; erases those
// below the minimum score.
Status Recognizer::RescoreByNcc(const cv::Mat& grey, std::vector<Detection>& detections) const {
  const StageScope scope(Stage::kNcc);
  const NccOptions& options = options_.ncc;
  cv::Mat scene;
  std::map<std::size_t, int> rescores;  // rescored detections by model index
  int in_frame = 0;
  for (Detection& detection : detections) {
    const RelitTemplateSource* const appearances = searchers_[detection.model_index]->relit_templates();
    if (appearances == nullptr) continue;
    if (detection.neg_log10_nfa < options.min_neg_log10_nfa || detection.neg_log10_nfa > options.max_neg_log10_nfa)
      continue;
    if (in_frame == options.max_poses_per_frame) break;
    if (rescores[detection.model_index]++ >= options.max_poses) continue;
    ++in_frame;
    if (scene.empty()) scene = PrepareSceneForNcc(grey);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<double> z_score,
                                ComputeNccZScore(scene, (*models_)[detection.model_index], *appearances, detection.view,
                                                 detection.fit.scene_from_template));
    if (!z_score) continue;
    detection.neg_log10_nfa += options.decades_per_z_score * (*z_score - options.neutral_z_score);
    detection.score = ComputeScore(detection.neg_log10_nfa);
  }
  std::erase_if(detections, [&](const Detection& one) { return one.score < options_.detect.min_score; });
  return {};
}

Expected<std::vector<Detection>> Recognizer::Recognize(const FeatureSet& features, const FrameConditions& conditions,
                                                       const cv::Mat& grey, const ViewPart& part) const {
  const PreparedScene scene(features, conditions.vertical, device_.get());
  std::vector<Expected<std::vector<Candidate>>> found(searchers_.size());
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
    oneapi::tbb::parallel_for(std::size_t{0}, searchers_.size(),
                              [&](std::size_t m) { found[m] = searchers_[m]->Search(scene, conditions, part); });
  });
  std::vector<Candidate> candidates;
  for (std::size_t m = 0; m < searchers_.size(); ++m) {
    if (!found[m]) return std::unexpected(std::move(found[m]).error());
    for (Candidate& candidate : *found[m]) {
      candidate.model_index = m;
      candidates.push_back(std::move(candidate));
    }
  }
  DetectOptions detect = options_.detect;
  const bool rescores = !grey.empty() && options_.ncc.max_poses > 0 && HasRelitTemplates();
  if (rescores) detect.min_score = std::min(detect.min_score, ComputeScore(options_.ncc.min_neg_log10_nfa));
  std::vector<Detection> detections = DetectIn(features, candidates, detect);
  if (rescores) VICTORIOUS_RETURN_IF_ERROR(RescoreByNcc(grey, detections));
  std::ranges::stable_sort(detections, [](const Detection& a, const Detection& b) {
    return a.score != b.score ? a.score > b.score : a.model_index < b.model_index;
  });
  return detections;
}

Expected<std::vector<Detection>> Recognizer::RecognizeViews(const FeatureSet& features, std::size_t model,
                                                            std::span<const std::size_t> views,
                                                            const FrameConditions& conditions) const {
  const PreparedScene scene(features, {}, device_.get());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Candidate> candidates,
                              searchers_[model]->SearchViews(scene, conditions, views));
  for (Candidate& candidate : candidates) candidate.model_index = model;
  return DetectIn(features, candidates, options_.detect);
}

bool Recognizer::HasRelitTemplates() const {
  return std::ranges::any_of(searchers_, [](const auto& searcher) { return searcher->relit_templates() != nullptr; });
}

Expected<std::optional<SunEstimate>> Recognizer::EstimateSun(const FeatureSet& features,
                                                             const Vertical& vertical) const {
  std::vector<RelightableModel> relightable;
  for (std::size_t m = 0; m < searchers_.size(); ++m) {
    if (const RelitTemplateSource* const templates = searchers_[m]->relit_templates())
      relightable.push_back({&(*models_)[m], templates, shortened_[m].get()});
  }
  return victorious::EstimateSun(relightable, PreparedScene(features, vertical, device_.get()), vertical,
                                 options_.search, options_.pose);
}

StagedMatches Recognizer::MatchView(const FeatureSet& features, std::size_t model, std::size_t view) const {
  return MatchViewByGrammar(PreparedScene(features), (*models_)[model], view,
                            {.match = options_.match, .cascade = options_.cascade, .pose = options_.pose});
}

}  // namespace victorious
