#include "experiments/indexed_movie.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "experiments/match_trial.h"
#include "victorious/base/file.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/lab/simulate/simulate.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Loads the models that the truth names and that have a CAD file; other truth rows are left out.
Expected<MovieWithTruth> LoadMovieWithTruth(const std::string& name, const fs::path& folder, const fs::path& cad_files,
                                            const ExperimentSettings& settings) {
  MovieWithTruth movie{.name = name, .folder = folder, .truth = {}, .models = {}, .relit_templates = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(movie.truth, ReadTruth(folder / "truth.jsonl"));
  VICTORIOUS_ASSIGN_OR_RETURN(movie.models, LoadTruthModels(movie.truth, cad_files, settings));
  std::erase_if(movie.truth, [&](const TruthRow& row) {
    return std::ranges::find(movie.models, row.model, &ObjectModel::name) == movie.models.end();
  });
  VICTORIOUS_ASSIGN_OR_RETURN(movie.relit_templates, MakeRelitViews(movie.models));
  return movie;
}

}  // namespace

IndexOptions TrackingIndexOptions() {
  IndexOptions options;
  options.every = 5;
  return options;
}

Expected<std::vector<ObjectModel>> LoadTruthModels(const std::vector<TruthRow>& truth, const fs::path& cad_files,
                                                   const ExperimentSettings& settings) {
  std::set<std::string> names;
  for (const TruthRow& row : truth) names.insert(row.model);
  std::vector<ObjectModel> models;
  for (const std::string& name : names) {
    const fs::path cad = cad_files / (name + ".glb");
    if (!fs::exists(cad)) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const auto model, LoadOrBuildModel(settings, cad, {}));
    models.push_back(*model);
  }
  if (models.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: no CAD files of the models in the truth: expected NAME.glb", cad_files.string()));
  }
  return models;
}

Expected<MovieWithTruth> SimulateScene(const std::string& name, const ExperimentSettings& settings) {
  const fs::path file = settings.scenes / (name + ".json");
  VICTORIOUS_ASSIGN_OR_RETURN(Scene scene, ReadScene(file));
  if (settings.frames > 0 && settings.frames < scene.video.frames) {
    scene.video.fps *= static_cast<double>(settings.frames - 1) / (scene.video.frames - 1);
    scene.video.frames = settings.frames;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content, ContentId(file, settings.Cancel()));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string cache_key,
                              settings.CacheKey(fmt::format("{} {}", content, scene.video.frames)));
  const fs::path folder = settings.out / "flights" / fmt::format("{}-{}", name, cache_key);
  if (!fs::exists(folder / "video.mp4")) {  // written last, so that its presence means a complete flight
    settings.progress(fmt::format("simulating {}", name));
    const auto warn = [&](const std::string& warning) { settings.progress(warning); };
    VICTORIOUS_RETURN_IF_ERROR(Simulate(scene, folder, {}, settings.Cancel(), warn));
  }
  return LoadMovieWithTruth(name, folder, scene.assets / "models", settings);
}

Expected<std::vector<MovieWithTruth>> SimulateScenes(const std::vector<std::string>& default_names,
                                                     const ExperimentSettings& settings) {
  std::vector<MovieWithTruth> movies;
  for (const std::string& name : settings.movies.empty() ? default_names : settings.movies) {
    VICTORIOUS_ASSIGN_OR_RETURN(movies.emplace_back(), SimulateScene(name, settings));
  }
  return movies;
}

Expected<MovieWithTruth> ReadMovie(const fs::path& folder, const ExperimentSettings& settings) {
  return LoadMovieWithTruth(folder.filename().string(), folder, settings.data / "models", settings);
}

Expected<std::unique_ptr<IndexStore>> IndexMovie(const MovieWithTruth& movie, const IndexOptions& options,
                                                 const ExperimentSettings& settings) {
  VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
  IndexOptions searched = options;
  searched.keep.interval_s = 1e6;  // these indexes are never queried by image
  FieldList fields;
  searched.ListSearchFields(fields);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string cache_key, settings.CacheKey(ToJsonText(fields.fields())));
  const fs::path folder = settings.out / "indexes" / movie.folder.filename();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), "make folder " + folder.string()));
  VICTORIOUS_ASSIGN_OR_RETURN(auto store, OpenSqliteStore(folder / (cache_key + ".db"), StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create(movie.models, searched));
  const IndexJob job{.video = (movie.folder / "video.mp4").string(),
                     .telemetry = (movie.folder / "telemetry.csv").string(),
                     .relit_templates = movie.relit_templates};
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const IndexReport report, indexer.Index(job, settings.Cancel(), *store));
  return store;
}

Expected<CameraTrajectory> ReadCameraTrack(const MovieWithTruth& movie) {
  const TelemetryOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry, ReadTelemetry((movie.folder / "telemetry.csv").string(), options));
  return CameraTrajectory(std::move(telemetry.states), options.max_gap_s);
}

Expected<double> MinRangeM(const MovieWithTruth& movie) {
  VICTORIOUS_ASSIGN_OR_RETURN(const CameraTrajectory cameras, ReadCameraTrack(movie));
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const TruthRow& row : movie.truth) {
    const std::optional<CameraState> camera = cameras.At(row.time_s);
    if (!camera || !row.place) continue;
    nearest_m = std::min(nearest_m, TangentPlane(camera->place).EnuFromGeodetic(*row.place).norm());
  }
  return nearest_m;
}

std::string DescribeMovies(const std::vector<MovieWithTruth>& movies) {
  std::vector<std::string> parts;
  for (const MovieWithTruth& movie : movies) {
    std::set<std::string> objects;
    std::int64_t frames = 0;
    for (const TruthRow& row : movie.truth) {
      objects.insert(row.object);
      frames = std::max(frames, row.frame + 1);
    }
    parts.push_back(fmt::format("{} ({} frames, {} objects)", movie.name, frames, objects.size()));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace victorious
