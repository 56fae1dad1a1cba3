#include "experiments/match_trial.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/file.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/preset.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/nearest_view.h"
#include "victorious/search/match/matcher.h"
#include "victorious/search/pose/similarity_pose.h"

namespace victorious {

MatchSetup DefaultSetup() {
  const IndexOptions index;
  MatchSetup setup{.kind = MatchSetup::Kind::kDefault,
                   .name = "ours",
                   .features = index.features,
                   .cad = {},
                   .recognize = index.recognize};
  setup.recognize.method = SearchMethod::kGrammar;
  return setup;
}

MatchSetup ThesisSetup() {
  IndexOptions index;
  CadModelOptions cad;
  const bool applied = ApplyPreset(Preset::kThesis, index) && ApplyPreset(Preset::kThesis, cad);
  VICTORIOUS_CHECK(applied);
  return {.kind = MatchSetup::Kind::kThesis,
          .name = "thesis",
          .features = index.features,
          .cad = cad,
          .recognize = index.recognize};
}

Expected<std::shared_ptr<const ObjectModel>> LoadOrBuildModel(const ExperimentSettings& settings,
                                                              const std::filesystem::path& cad_file,
                                                              const CadModelOptions& options) {
  const std::string name = cad_file.stem().string();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content, ContentId(cad_file, settings.Cancel()));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string cache_key, settings.CacheKey(OptionsToJsonText(options)));
  const ModelLibrary library(settings.out / "models" / fmt::format("{}-{}", content, cache_key));
  Expected<ObjectModel> model = library.Load(name);
  if (!model && model.error().code == ErrorCode::kNotFound) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    settings.progress(fmt::format("building the model of {}", cad_file.string()));
    VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(cad_file));
    VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel made,
                                MakeCadModel(name, loaded.mesh, cad_file.filename().string(), options));
    made.length_m = loaded.length_m;
    VICTORIOUS_RETURN_IF_ERROR(library.Add(made));
    model = library.Load(name);  // memory-mapped and with its id, as on later calls
  }
  if (!model) return std::unexpected(std::move(model).error());
  return std::make_shared<const ObjectModel>(*std::move(model));
}

MatchTrial MakeTrial(std::shared_ptr<const AnnotatedImage> scene, std::shared_ptr<const FeatureSet> features,
                     std::shared_ptr<const ObjectModel> model, std::size_t view) {
  const std::string kind = model->name;
  const ModelView& of = model->views[view];
  const MatchTruth truth(*scene, kind, model->points_in_model.subspan(of.first_feature, of.feature_count),
                         model->box_m->diagonal().norm());
  return {.name = kind + " in " + scene->name,
          .scene = std::move(scene),
          .features = std::move(features),
          .model = std::move(model),
          .view = view,
          .truth = truth,
          .flight = 0};
}

MatchSet MatchTrial::Matches(double ratio) const {
  const FeatureView view_features = Template();
  return MatchFeatures(features->View(), TemplateSet(std::span(&view_features, 1)), {.ratio = ratio}).front();
}

MatchSet MatchTrial::Mlesac(const MatchSet& matches, const PoseOptions& options) const {
  const double area_px2 = static_cast<double>(features->image_width) * features->image_height;
  const std::vector<PlanarFit> fits =
      EstimatePoses(features->keypoints, Template().keypoints, matches, model->views[view].outline, area_px2, options);
  return fits.empty() ? MatchSet() : SelectInliers(matches, fits.front());
}

StageMatches RunStages(const MatchTrial& trial, double ratio, const RecognizeOptions& options) {
  const MatchSet matches = trial.Matches(ratio);
  CascadeResult left = FilterByGrammar(trial.features->keypoints, trial.Template().keypoints, matches, options.cascade);
  MatchSet inliers = trial.Mlesac(left.third, options.pose);
  return {{matches, std::move(left.first), std::move(left.second), std::move(left.third), std::move(inliers)}};
}

Expected<std::shared_ptr<const FeatureSet>> ExtractImageFeatures(const AnnotatedImage& scene,
                                                                 const FeatureOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options));
  VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet features, extractor->Extract(GreyFromBgr(scene.bgr)));
  return std::make_shared<const FeatureSet>(std::move(features));
}

Expected<MatchTrial> RunningExample(const ExperimentSettings& settings, const MatchSetup& setup,
                                    const std::string& kind) {
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create({.software = true}));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const SceneRenderer town,
      SceneRenderer::Load(settings.scenes / fmt::format("chapter3_{}.json", kind), renderer, settings.Cancel()));
  VICTORIOUS_ASSIGN_OR_RETURN(AnnotatedImage scene, town.Draw(0));
  const LabelledObject* const object = scene.Find(kind);
  if (object == nullptr) return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must show a {}", scene.name, kind));
  const ViewDirection view = object->view;
  VICTORIOUS_ASSIGN_OR_RETURN(auto features, ExtractImageFeatures(scene, setup.features));
  VICTORIOUS_ASSIGN_OR_RETURN(auto model,
                              LoadOrBuildModel(settings, town.scene().assets / "models" / (kind + ".glb"), setup.cad));
  const std::size_t nearest = NearestView(*model, view);
  return MakeTrial(std::make_shared<const AnnotatedImage>(std::move(scene)), std::move(features), std::move(model),
                   nearest);
}

}  // namespace victorious
