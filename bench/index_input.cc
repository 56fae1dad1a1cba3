#include "bench/index_input.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "testing/data.h"
#include "victorious/base/cancel.h"
#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/version.h"
#include "victorious/lab/simulate/scene.h"
#include "victorious/lab/simulate/simulate.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/model_library.h"

namespace victorious::bench {
namespace {

namespace fs = std::filesystem;

// The thesis's four objects.
constexpr std::array<std::string_view, 4> kFirstModels = {"abrams", "apache", "humvee", "mig29"};
constexpr double kQuickStep_deg = 45;
constexpr int kQuickFrames = 2;

fs::path SourcePath(const char* relative) { return fs::path(VICTORIOUS_SOURCE_DIR) / relative; }

Expected<IndexMovie> SimulateMovie(const Settings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(Scene scene, ReadScene(SourcePath("scenes/straight.json")));
  if (settings.quick) scene.video.frames = kQuickFrames;
  const fs::path folder = settings.cache / fmt::format("straight-{}-{}", kVersion, scene.video.frames);
  if (!fs::exists(folder / "video.mp4")) {  // written last
    VICTORIOUS_RETURN_IF_ERROR(Simulate(scene, folder, {}, CancelToken(), [](const std::string&) {}));
  }
  return IndexMovie{"straight", folder, scene.assets / "models"};
}

}  // namespace

Expected<std::vector<IndexMovie>> FindIndexMovies(const Settings& settings) {
  std::vector<IndexMovie> movies;
  if (!settings.quick) {
    for (const fs::path& folder : ListFolder(testing::DataPath("movies")).value_or(std::vector<fs::path>())) {
      std::error_code absent;
      if (!fs::exists(folder / "video.mp4", absent)) continue;
      movies.push_back({folder.filename().string(), folder, testing::DataPath("models")});
    }
  }
  if (movies.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(movies.emplace_back(), SimulateMovie(settings));
  }
  return movies;
}

std::vector<std::string> ListModels(const fs::path& cad_files) {
  std::vector<std::string> names;
  for (const fs::path& path : ListFolder(cad_files).value_or(std::vector<fs::path>())) {
    if (path.extension() == ".glb") names.push_back(path.stem().string());
  }
  std::ranges::sort(names, {}, [](const std::string& name) {
    return std::pair(std::ranges::find(kFirstModels, name) == kFirstModels.end(), name);
  });
  return names;
}

Expected<ObjectModel> LoadIndexModel(const fs::path& cad_file, const Settings& settings) {
  CadModelOptions options;
  if (settings.quick) options.sphere.step_deg = kQuickStep_deg;
  const std::string name = cad_file.stem().string();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content, ContentId(cad_file, CancelToken()));
  const ModelLibrary library(
      settings.cache / fmt::format("{}-{}-{}-{}", content, options.features.engine, kVersion, options.sphere.step_deg));
  Expected<ObjectModel> model = library.Load(name);
  if (model || model.error().code != ErrorCode::kNotFound) return model;
  fmt::print(stderr, "making the model {}\n", name);
  VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(cad_file));
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel made, MakeCadModel(name, loaded.mesh, cad_file.filename().string(), options));
  made.length_m = loaded.length_m;
  VICTORIOUS_RETURN_IF_ERROR(library.Add(made));
  return library.Load(name);
}

}  // namespace victorious::bench
