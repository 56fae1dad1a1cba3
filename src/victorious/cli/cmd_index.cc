// victorious index VIDEO... --models DIR --categories FILE --db FILE
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "victorious/category/category_file.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/output_files.h"
#include "victorious/geometry/angles.h"
#include "victorious/model/model_library.h"
#include "victorious/pipeline/indexer.h"
#include "victorious/video/video_reader.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::vector<std::string> videos;
  std::string models;
  std::string categories;
  std::string db;
  std::string params;
  std::optional<std::string> telemetry;
  std::optional<int> every;
  std::optional<double> hfov_deg;
  CameraArguments camera;
  GroundArguments ground;
  bool redo = false;
  int threads = 0;
};

Error CombineErrors(const std::optional<Error>& one, const Error& other) {
  return one ? Error{one->code, one->message + "; " + other.message} : other;
}

// Fails if no video can be opened, so that no empty index is created.
Status CheckAnyOpens(const std::vector<std::string>& videos) {
  std::optional<Error> failure;
  for (const std::string& video : videos) {
    if (video.contains("://")) return {};  // a live source is opened once
    const auto opened = VideoReader::Open(video, {});
    if (opened) return {};
    failure = CombineErrors(failure, opened.error());
  }
  if (failure) return std::unexpected(*std::move(failure));
  return {};
}

// Warns of objects whose place was rejected: their telemetry may be of another flight.
Status WarnOfRejectedPlaces(IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects({}));
  const auto rejected = [](const ObjectRecord& object) { return !object.place_rejected.empty(); };
  const auto first = std::ranges::find_if(objects, rejected);
  if (first == objects.end()) return {};
  spdlog::warn(
      "{} of {} objects in the index have no place, although there is telemetry (the first: {}): it may belong "
      "to another flight or have a wrong clock; `victorious search` lists the reasons",
      std::ranges::count_if(objects, rejected), objects.size(), first->place_rejected);
  return {};
}

Status Run(const Arguments& arguments, const CLI::App& app) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(app, {{"--db", arguments.db, std::nullopt}}));
  if (arguments.telemetry && arguments.videos.size() > 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "--telemetry applies to one video: index several videos one after the other");
  }
  if (arguments.models.empty() && arguments.categories.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "nothing to search for: give --models (`victorious model add` makes one), --categories (`victorious "
                "category train` makes one), or both");
  }
  IndexOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.every) options.every = *arguments.every;
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(CollectFields(options), {{"every", "--every"}}));
  if (arguments.hfov_deg) options.telemetry.hfov_deg = *arguments.hfov_deg;
  ApplyCamera(arguments.camera, options.telemetry);
  ApplyGround(arguments.ground, options.ground);
  std::vector<ObjectModel> models;
  if (!arguments.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(models, ModelLibrary(arguments.models).LoadAll());
    if (models.empty()) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("{}: no models; make one with `victorious model add`", arguments.models));
    }
  }
  std::optional<CategoryModel> categories;
  if (!arguments.categories.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(categories, ReadCategoryModel(arguments.categories));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer,
                              Indexer::Create(std::move(models), options, std::move(categories),
                                              [](const std::string& warning) { spdlog::warn("{}", warning); }));
  std::error_code error;
  if (!std::filesystem::exists(arguments.db, error)) VICTORIOUS_RETURN_IF_ERROR(CheckAnyOpens(arguments.videos));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store,
                              OpenSqliteStore(arguments.db, StoreMode::kCreate));
  // A video that cannot be read does not prevent the others from being indexed.
  std::optional<Error> failure;
  for (const std::string& video : arguments.videos) {
    const auto warn = [&](const std::string& warning) { spdlog::warn("{}: {}", video, warning); };
    const IndexJob job{
        .video = video, .telemetry = arguments.telemetry, .redo = arguments.redo, .threads = arguments.threads};
    const Expected<IndexReport> report = indexer.Index(job, Interrupt(), *store, warn);
    if (!report) {
      failure = CombineErrors(failure, report.error());
      if (report.error().code == ErrorCode::kCancelled) break;
      continue;
    }
    if (report->stopped_live) spdlog::info("{}: live source, indexed up to the interruption", OneLine(video));
    const bool is_indexed = report->frames_searched == 0 && !report->stopped_live;
    if (report->sun) {
      const double azimuth_deg = DegreesFromRadians(report->sun->azimuth_rad);
      spdlog::info("{}: sun at azimuth {:.0f}, elevation {:.0f} degrees", OneLine(video),
                   azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg, DegreesFromRadians(report->sun->elevation_rad));
    }
    spdlog::info("{}: {} frames searched, {} sightings{}", OneLine(video), report->frames_searched, report->sightings,
                 is_indexed ? " (already indexed)" : "");
  }
  if (failure) return std::unexpected(*std::move(failure));
  return WarnOfRejectedPlaces(*store);
}

}  // namespace

Action SetUpIndex(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("VIDEO", arguments->videos, "Files, folders of frames, or live URLs")->required();
  app.add_option("--models", arguments->models, "Folder of models to search for")->type_name("DIR");
  app.add_option("--categories", arguments->categories,
                 "A category model (`victorious category train`), whose categories are searched for as well")
      ->type_name("FILE");
  app.add_option("--db", arguments->db, "The index; created if it does not exist")->required()->type_name("FILE");
  app.add_option("--telemetry", arguments->telemetry,
                 "Camera states (default: the video's own KLV, or NAME.SRT or NAME.telemetry.csv beside it)")
      ->type_name("FILE");
  AddParams(app, arguments->params, "index");
  app.add_option("--every", arguments->every,
                 "Search every N-th frame completely; in between, only regions around tracked objects")
      ->type_name("N");
  AddFieldOfView(app, arguments->hfov_deg);
  AddCamera(app, arguments->camera);
  AddGround(app, arguments->ground);
  app.add_flag("--redo", arguments->redo,
               "Delete the results of these models and categories in these videos, and search again");
  app.add_option("--threads", arguments->threads, "Number of threads; 0: one per processor")
      ->check(CLI::Range(0, 1024));
  return [=, &app] { return Run(*arguments, app); };
}

}  // namespace victorious::cli
