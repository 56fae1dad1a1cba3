#include "victorious/recognize/recognizer.h"

#include <utility>

#include <fmt/format.h>

namespace victorious {

void RecognizeOptions::ListFields(FieldList& fields) {
  fields.AddGroup("match", match);
  fields.AddGroup("cascade", cascade);
  fields.AddGroup("pose", pose);
  fields.AddGroup("detect", detect);
}

Status CheckEngine(std::span<const ObjectModel> models, std::string_view engine) {
  for (const ObjectModel& model : models) {
    if (model.engine == engine) continue;
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("model {} has features of the engine {}, the search uses {}: make the model again with that engine",
                    model.name, model.engine, engine));
  }
  return {};
}

Expected<Recognizer> Recognizer::Create(std::vector<ObjectModel> models, const std::string& engine,
                                        const RecognizeOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_RETURN_IF_ERROR(CheckEngine(models, engine));
  std::vector<ViewRef> refs;
  std::vector<FeatureView> templates;
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (std::size_t v = 0; v < models[m].views.size(); ++v) {
      refs.push_back({m, v});
      templates.push_back(models[m].ViewFeatures(v));
    }
  }
  return Recognizer(std::move(models), std::move(refs), TemplateSet(templates), options);
}

Recognizer::Recognizer(std::vector<ObjectModel> models, std::vector<ViewRef> views, TemplateSet templates,
                       const RecognizeOptions& options)
    : models_(std::move(models)), views_(std::move(views)), templates_(std::move(templates)), options_(options) {}

StagedMatches Recognizer::Filter(const FeatureSet& scene, const ViewRef& ref, MatchSet matches) const {
  const ObjectModel& model = models_[ref.model];
  const std::span<const Keypoint> template_keypoints = model.ViewFeatures(ref.view).keypoints;
  const double scene_area_px2 = static_cast<double>(scene.image_width) * scene.image_height;
  StagedMatches staged;
  staged.ratio = std::move(matches);
  staged.cascade = FilterByGrammar(scene.keypoints, template_keypoints, staged.ratio, options_.cascade);
  staged.poses = EstimatePoses(scene.keypoints, template_keypoints, staged.cascade.third, model.views[ref.view].outline,
                               scene_area_px2, options_.pose);
  return staged;
}

std::vector<Detection> Recognizer::Recognize(const FeatureSet& scene) const {
  std::vector<MatchSet> matches = MatchFeatures(scene.View(), templates_, options_.match);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    StagedMatches staged = Filter(scene, views_[i], std::move(matches[i]));
    for (Pose& pose : staged.poses) {
      candidates.push_back({.model = views_[i].model,
                            .view = views_[i].view,
                            .matches = staged.ratio.size(),
                            .views = models_[views_[i].model].views.size(),
                            .outline = models_[views_[i].model].views[views_[i].view].outline,
                            .pose = std::move(pose)});
    }
  }
  const SceneSize size{static_cast<double>(scene.image_width), static_cast<double>(scene.image_height)};
  return Detect(candidates, size, options_.detect);
}

StagedMatches Recognizer::MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const {
  const FeatureView features = models_[model].ViewFeatures(view);
  std::vector<MatchSet> matches = MatchFeatures(scene.View(), TemplateSet(std::span(&features, 1)), options_.match);
  return Filter(scene, {model, view}, std::move(matches.front()));
}

}  // namespace victorious
