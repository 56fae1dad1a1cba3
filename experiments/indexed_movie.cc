#include "experiments/indexed_movie.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/file.h"
#include "experiments/match_trial.h"
#include "victorious/model/relit_views.h"
#include "victorious/pipeline/indexer.h"
#include "victorious/pipeline/video_telemetry.h"
#include "victorious/simulate/simulate.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Loads the models that the truth names and that have a CAD file; other truth rows are left out.
Expected<TrueMovie> ReadTrueMovie(const std::string& name, const fs::path& folder, const fs::path& cad_files,
                                  const ExperimentSettings& settings) {
  TrueMovie movie{.name = name, .folder = folder, .truth = {}, .models = {}, .lit = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(movie.truth, ReadTruth(folder / "truth.jsonl"));
  std::set<std::string> kinds;
  for (const TruthRow& row : movie.truth) kinds.insert(row.model);
  for (const std::string& kind : kinds) {
    const fs::path cad = cad_files / (kind + ".glb");
    if (!fs::exists(cad)) {
      std::erase_if(movie.truth, [&](const TruthRow& row) { return row.model == kind; });
      continue;
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const auto model, KeptModel(settings, cad, {}));
    movie.models.push_back(*model);
    VICTORIOUS_ASSIGN_OR_RETURN(movie.lit.emplace_back(), MakeLitViews(*model));
  }
  if (movie.models.empty()) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no CAD files of the models in {}: expected NAME.glb",
                                                  cad_files.string(), folder.string()));
  }
  return movie;
}

}  // namespace

IndexOptions FollowingOptions() {
  IndexOptions options;
  options.every = 5;
  return options;
}

Expected<TrueMovie> FlyScene(const std::string& name, const ExperimentSettings& settings) {
  const fs::path file = settings.scenes / (name + ".json");
  VICTORIOUS_ASSIGN_OR_RETURN(Scene scene, ReadScene(file));
  if (settings.frames > 0 && settings.frames < scene.video.frames) {
    scene.video.fps *= static_cast<double>(settings.frames - 1) / (scene.video.frames - 1);
    scene.video.frames = settings.frames;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content, ContentId(file, settings.Cancel()));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string kept_as,
                              settings.KeptAs(fmt::format("{} {}", content, scene.video.frames)));
  const fs::path folder = settings.out / "flights" / fmt::format("{}-{}", name, kept_as);
  if (!fs::exists(folder / "video.mp4")) {  // written last, so that its presence means a complete flight
    settings.progress(fmt::format("simulating {}", name));
    const auto warn = [&](const std::string& warning) { settings.progress(warning); };
    VICTORIOUS_RETURN_IF_ERROR(Simulate(scene, folder, {}, settings.Cancel(), warn));
  }
  return ReadTrueMovie(name, folder, scene.assets / "models", settings);
}

Expected<std::vector<TrueMovie>> FlyScenes(const std::vector<std::string>& unless_named,
                                           const ExperimentSettings& settings) {
  std::vector<TrueMovie> movies;
  for (const std::string& name : settings.movies.empty() ? unless_named : settings.movies) {
    VICTORIOUS_ASSIGN_OR_RETURN(movies.emplace_back(), FlyScene(name, settings));
  }
  return movies;
}

Expected<TrueMovie> ReadMovie(const fs::path& folder, const ExperimentSettings& settings) {
  return ReadTrueMovie(folder.filename().string(), folder, settings.data / "models", settings);
}

Expected<std::unique_ptr<IndexStore>> IndexOf(const TrueMovie& movie, const IndexOptions& options,
                                              const ExperimentSettings& settings) {
  VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
  IndexOptions searched = options;
  searched.keep.interval_s = 1e6;  // these indexes are never queried by image
  FieldList fields;
  searched.ListSearchFields(fields);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string kept_as, settings.KeptAs(ToJsonText(fields.fields())));
  const fs::path folder = settings.out / "indexes" / movie.folder.filename();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), "make folder " + folder.string()));
  VICTORIOUS_ASSIGN_OR_RETURN(auto store, OpenSqliteStore(folder / (kept_as + ".db"), StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create(movie.models, searched));
  const IndexJob job{.video = (movie.folder / "video.mp4").string(),
                     .telemetry = (movie.folder / "telemetry.csv").string(),
                     .lit = movie.lit};
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const IndexReport report, indexer.Index(job, settings.Cancel(), *store));
  return store;
}

Expected<CameraTrack> CamerasOf(const TrueMovie& movie) {
  const TelemetryOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry, ReadTelemetry((movie.folder / "telemetry.csv").string(), options));
  return CameraTrack(std::move(telemetry.states), options.max_gap_s);
}

Expected<double> NearestRangeM(const TrueMovie& movie) {
  VICTORIOUS_ASSIGN_OR_RETURN(const CameraTrack cameras, CamerasOf(movie));
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const TruthRow& row : movie.truth) {
    const std::optional<CameraState> camera = cameras.At(row.time_s);
    if (!camera || !row.place) continue;
    nearest_m = std::min(nearest_m, TangentPlane(camera->place).EnuFromGeodetic(*row.place).norm());
  }
  return nearest_m;
}

std::string Describe(const std::vector<TrueMovie>& movies) {
  std::vector<std::string> parts;
  for (const TrueMovie& movie : movies) {
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
