#include "experiments/match_pool.h"

#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "experiments/video_frames.h"
#include "victorious/base/folder.h"
#include "victorious/object/model/nearest_view.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

Expected<std::vector<fs::path>> ListSorted(const fs::path& folder, bool folders) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<fs::path> paths, ListFolder(folder));
  std::erase_if(paths, [&](const fs::path& path) {
    std::error_code gone;
    return fs::is_directory(path, gone) != folders || (!folders && path.extension() != ".json");
  });
  return paths;
}

}  // namespace

Expected<std::vector<PooledScene>> PoolScenes(const ExperimentSettings& settings, int frames, IncludeMovies with) {
  std::vector<PooledScene> pool;
  int flights = 0;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> files, ListSorted(settings.scenes, false));
  for (const fs::path& file : files) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    settings.progress("rendering " + file.string());
    VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create({.software = true}));
    VICTORIOUS_ASSIGN_OR_RETURN(const SceneRenderer town, SceneRenderer::Load(file, renderer, settings.Cancel()));
    for (const std::int64_t frame : EvenlySpaced(town.scene().video.frames, frames)) {
      VICTORIOUS_ASSIGN_OR_RETURN(AnnotatedImage drawn, town.Draw(static_cast<int>(frame)));
      pool.push_back({.scene = std::make_shared<const AnnotatedImage>(std::move(drawn)),
                      .cad_folder = town.scene().assets / "models",
                      .flight = flights});
    }
    ++flights;
  }
  const fs::path movies = settings.data / "movies";
  const bool any_movies = with == IncludeMovies::kYes && fs::exists(movies);
  if (pool.empty() && !any_movies) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no scene files: expected NAME.json", settings.scenes.string()));
  }
  if (!any_movies) return pool;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> folders, ListSorted(movies, true));
  for (const fs::path& folder : folders) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    settings.progress("reading " + folder.string());
    VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create({.software = true}));
    const fs::path models = settings.data / "models";
    VICTORIOUS_ASSIGN_OR_RETURN(auto known, ReadLabelledMovie(folder, models, frames, renderer));
    for (AnnotatedImage& scene : known) {
      pool.push_back(
          {.scene = std::make_shared<const AnnotatedImage>(std::move(scene)), .cad_folder = models, .flight = flights});
    }
    ++flights;
  }
  return pool;
}

Expected<std::vector<MatchTrial>> PoolTrials(const ExperimentSettings& settings, const MatchSetup& setup,
                                             const std::vector<PooledScene>& scenes) {
  constexpr double kMinVisible = 0.5;
  std::map<fs::path, std::shared_ptr<const ObjectModel>> models;
  std::vector<MatchTrial> trials;
  for (const PooledScene& pooled : scenes) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    VICTORIOUS_ASSIGN_OR_RETURN(const auto features, ExtractImageFeatures(*pooled.scene, setup.features));
    std::set<std::string> kinds;
    for (const LabelledObject& object : pooled.scene->objects) {
      if (object.visible < kMinVisible || !kinds.insert(object.model).second) continue;
      const fs::path cad_file = pooled.cad_folder / (object.model + ".glb");
      std::shared_ptr<const ObjectModel>& model = models[cad_file];
      if (!model) {
        VICTORIOUS_ASSIGN_OR_RETURN(model, LoadOrBuildModel(settings, cad_file, setup.cad));
      }
      trials.push_back(MakeTrial(pooled.scene, features, model, NearestView(*model, object.view)));
      trials.back().flight = pooled.flight;
    }
  }
  return trials;
}

}  // namespace victorious
