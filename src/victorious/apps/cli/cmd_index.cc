// victorious index VIDEO... --models DIR --categories FILE --db DB
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/detection_arguments.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/apps/cluster/index_task.h"
#include "victorious/base/count_text.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/program_events.h"
#include "victorious/base/stage_time.h"
#include "victorious/base/text.h"
#include "victorious/base/write_access.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/video/stream_recorder.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/jobs/preset.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/show/drawn_video.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/postgres_segment_store.h"

namespace victorious::cli {
namespace {

// What computes the distances of descriptors.
enum class DeviceChoice { kAuto, kCpu, kCuda };
constexpr auto kDeviceTexts = std::to_array<EnumText<DeviceChoice>>(
    {{DeviceChoice::kAuto, "auto"}, {DeviceChoice::kCpu, "cpu"}, {DeviceChoice::kCuda, "cuda"}});

struct IndexArguments {
  std::vector<std::string> videos;
  std::string models;
  std::string categories;
  DetectionArguments list;
  std::string db;
  SearchSettings search;
  IndexJob job;  // of each video
  std::string keep_features;
  std::string cache;
  std::string device = "auto";
  std::optional<double> budget_ms;
  std::optional<double> hfov_deg;
  CameraArguments camera;
  GroundArguments ground;
  bool redo = false;
  bool redo_other = false;
  bool json = false;
  std::string draw;
  std::optional<double> cut_s;
  std::string frames;
  std::string task;
  std::string targets;
  std::vector<std::string> files_below;
};

// What is done with one video.
struct Work {
  IndexStore& store;
  SegmentStore* segments = nullptr;  // of --cut and --frames
  std::optional<double> cut_s;
  std::optional<FrameInterval> frames;
};

Error CombineErrors(const std::optional<Error>& one, const Error& other) {
  return one ? Error{one->code, one->message + "; " + other.message} : other;
}

Status CheckVideo(const std::string& video, std::optional<double> from_s) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<VideoReader> opened, VideoReader::Open(video, {}));
  const std::optional<double> end_s = opened->info().duration_s;
  if (!from_s || !end_s || opened->info().is_duration_estimated || *from_s < *end_s) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: --from {:g} is after its end, {:.2f} s: give an earlier time", video, *from_s, *end_s));
}

// Opens every video before the first is searched, so that a wrong name does not show up after hours.
// @return the error of each video that cannot be opened, or that ends before `from_s`. A live source is opened once,
//   when it is searched
std::map<std::string, Error> FindUnsearchable(const std::vector<std::string>& videos, std::optional<double> from_s) {
  std::map<std::string, Error> unsearchable;
  for (const std::string& video : videos) {
    if (video.contains("://")) continue;
    if (const Status status = CheckVideo(video, from_s); !status) unsearchable.emplace(video, status.error());
  }
  return unsearchable;
}

// Sets the interval of kept features from "none" or a number of seconds.
Status SetKeptFeatures(const std::string& text, KeepOptions& keep) {
  if (text.empty()) return {};
  if (text == "none") {
    keep.interval_s = -1;
    return {};
  }
  const std::optional<double> interval_s = ParseNumber(text);
  if (!interval_s || *interval_s < 0 || *interval_s > 1e6) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--keep-features {}: give the seconds between kept frames, from 0, or none", OneLine(text)));
  }
  keep.interval_s = *interval_s;
  return {};
}

Expected<IndexOptions> ReadOptions(const IndexArguments& arguments, const std::vector<ObjectModel>& models) {
  VICTORIOUS_ASSIGN_OR_RETURN(IndexOptions options, ReadIndexOptions(arguments.search, models));
  VICTORIOUS_RETURN_IF_ERROR(SetKeptFeatures(arguments.keep_features, options.keep));
  if (arguments.hfov_deg) options.telemetry.hfov_deg = *arguments.hfov_deg;
  VICTORIOUS_RETURN_IF_ERROR(ApplyCamera(arguments.camera, options.telemetry));
  ApplyGround(arguments.ground, options.ground);
  return options;
}

// A folder that was named must be there to be written; the user's own may be missing.
// @param cache  of --cache
Expected<std::shared_ptr<const RelitTemplateFolder>> OpenRelitTemplates(const std::string& cache) {
  if (cache == "none") return nullptr;
  if (cache.empty()) return OpenUsersRelitTemplates();
  std::error_code ignored;
  std::filesystem::create_directories(cache, ignored);
  if (!std::filesystem::is_directory(cache, ignored) || !IsWritable(cache)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--cache {}: not a folder that can be written: give one, or none", OneLine(cache)));
  }
  return RelitTemplateFolder::Open(cache);
}

// The categories that are searched for, or what another program found; std::nullopt: neither.
Expected<std::optional<CategorySourceInput>> ReadCategories(const IndexArguments& arguments) {
  if (!arguments.list.file.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(DetectionList list, ReadDetections(arguments.list, arguments.videos.front()));
    return std::optional<CategorySourceInput>(std::move(list));
  }
  if (arguments.categories.empty()) return std::optional<CategorySourceInput>();
  VICTORIOUS_ASSIGN_OR_RETURN(CategorySourceModel categories, ReadCategorySource(arguments.categories));
  return std::optional<CategorySourceInput>(std::move(categories));
}

// What another program found is entered anew: that costs no search.
Redo RedoOf(const IndexArguments& arguments) {
  if (arguments.redo || !arguments.list.file.empty()) return Redo::kAlways;
  return arguments.redo_other ? Redo::kIfDifferent : Redo::kNever;
}

Status CheckArguments(const IndexArguments& arguments) {
  if (!arguments.job.covers.empty() && !RecordingStart(arguments.videos.front())) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--covers: {} is not named as a recording: give a file of `victorious record`",
                            OneLine(arguments.videos.front())));
  }
  if (!arguments.draw.empty() && arguments.videos.size() > 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "--draw applies to one video: draw the others by `victorious export --format video --video NAME`");
  }
  if (arguments.job.telemetry && arguments.videos.size() > 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "--telemetry applies to one video: index several videos one after the other");
  }
  const bool has_list = !arguments.list.file.empty();
  VICTORIOUS_RETURN_IF_ERROR(CheckDetections(arguments.list));
  if (has_list && !(arguments.models.empty() && arguments.categories.empty() && arguments.videos.size() == 1)) {
    return Fail(ErrorCode::kInvalidArgument,
                "--detections are those of one video, and are entered, not searched for: give one VIDEO, and neither "
                "--models nor --categories");
  }
  const bool is_part = arguments.job.from_s || arguments.job.to_s || arguments.cut_s || !arguments.frames.empty() ||
                       !arguments.job.covers.empty();
  if (has_list && (is_part || !arguments.keep_features.empty())) {
    return Fail(ErrorCode::kInvalidArgument,
                "--detections are entered for the whole video, and no features are kept: give none of --from, --to and "
                "--keep-features");
  }
  if (arguments.models.empty() && arguments.categories.empty() && !has_list) {
    return Fail(ErrorCode::kInvalidArgument,
                "nothing to search for: give --models (`victorious model add` makes one), --categories (`victorious "
                "category train` or `category import` makes one), or both; or --detections, what another program "
                "found");
  }
  if (arguments.job.from_s && arguments.job.to_s && *arguments.job.from_s > *arguments.job.to_s) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--from {:g} is after --to {:g}: --to must be the later time",
                                                         *arguments.job.from_s, *arguments.job.to_s));
  }
  if (arguments.videos.size() > 1 && (!arguments.job.name.empty() || !arguments.job.content_id.empty())) {
    return Fail(ErrorCode::kInvalidArgument, "--stored-as and --content-id apply to one video");
  }
  if (!arguments.cut_s && arguments.frames.empty() && arguments.task.empty()) return {};
  if (!IsDatabaseUrl(arguments.db)) {
    return Fail(ErrorCode::kInvalidArgument,
                "--cut, --frames and --task are for workers, which share a database: give --db "
                "postgresql://USER@HOST/DATABASE");
  }
  if (!arguments.cut_s && arguments.frames.empty()) return {};
  if (arguments.videos.size() > 1 || arguments.redo || arguments.job.from_s || arguments.job.to_s ||
      !arguments.draw.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--cut and --frames apply to one whole video: leave out --redo, --from, --to and --draw");
  }
  if (arguments.budget_ms) {
    return Fail(ErrorCode::kInvalidArgument,
                "--cut and --frames give the same results on every machine, which --budget-ms does not: leave it out");
  }
  return {};
}

double AzimuthDeg(const Sun& sun) {
  const double azimuth_deg = DegreesFromRadians(sun.azimuth_rad);
  return azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg;
}

// An estimate of the image is a consensus of frames within 30 degrees (place/calibrate/sun_direction.h).
std::string SunText(const IndexReport& report) {
  const std::string by_clock = "by the telemetry's clock";
  const std::string by_image = "within some 30 degrees, estimated from the shading of the models found";
  return fmt::format("sun at azimuth {:.0f}{}, elevation {:.0f} degrees, {}", AzimuthDeg(*report.sun),
                     report.sun_from_camera ? " from the camera's first direction" : "",
                     DegreesFromRadians(report.sun->elevation_rad), report.sun_by_clock ? by_clock : by_image);
}

void LogReport(const std::string& video, const IndexReport& report) {
  if (report.stopped_live) LogInfo("{}: live source, indexed up to the interruption", OneLine(video));
  if (report.sun) LogInfo("{}: {}", OneLine(video), SunText(report));
  if (report.frames_left_out > 0) {
    LogInfo("{}: {} of the {} due for a full search {} only tracked, to keep pace", OneLine(video),
            report.frames_left_out, CountText(report.frames_searched + report.frames_left_out, "frame"),
            report.frames_left_out == 1 ? "was" : "were");
  }
  const bool is_indexed = report.frames_searched == 0 && !report.stopped_live;
  LogInfo("{}: {} searched, {}{}{}", OneLine(video), CountText(report.frames_searched, "frame"),
          CountText(report.sightings, "sighting"), is_indexed ? " (already indexed)" : "",
          report.has_telemetry ? "" : "; there is no telemetry, so that nothing gets a place");
}

// Processor time of each stage since MeasureStages, s.
nlohmann::ordered_json StagesToJson() {
  const std::array<double, kStageCount> times_s = StageTimes();
  nlohmann::ordered_json stages;
  for (const auto& [stage, name] : kStageTexts) stages[std::string(name)] = times_s[static_cast<std::size_t>(stage)];
  return stages;
}

nlohmann::ordered_json ToJson(const std::string& video, const IndexReport& report) {
  nlohmann::ordered_json sun;
  if (report.sun) {
    sun = {{"azimuth_deg", AzimuthDeg(*report.sun)},
           {"elevation_deg", DegreesFromRadians(report.sun->elevation_rad)},
           {"by_clock", report.sun_by_clock},
           {"from_camera", report.sun_from_camera}};
  }
  return {{"video", video},
          {"frames_searched", report.frames_searched},
          {"frames_left_out", report.frames_left_out},
          {"sightings", report.sightings},
          {"stopped_live", report.stopped_live},
          {"sun", std::move(sun)},
          {"stages_s", StagesToJson()}};
}

// Two whole numbers of at least 0, "1:2".
std::optional<std::pair<std::int64_t, std::int64_t>> ReadPair(const std::string& text) {
  std::pair<std::int64_t, std::int64_t> numbers;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, numbers.first);
  const bool has_first = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto second = std::from_chars(has_first ? first.ptr + 1 : end, end, numbers.second);
  if (!has_first || second.ec != std::errc() || second.ptr != end || numbers.first < 0 || numbers.second < 0) {
    return std::nullopt;
  }
  return numbers;
}

// "FROM:TO", as `work` gives it.
Expected<std::optional<FrameInterval>> ParseFrames(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto numbers = ReadPair(text);
  if (!numbers || numbers->first >= numbers->second) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--frames {}: give FROM:TO, the first frame of a segment and the one after it", OneLine(text)));
  }
  return FrameInterval{numbers->first, numbers->second};
}

// "TASK:ATTEMPT", as `work` gives it.
Expected<std::optional<TaskAttempt>> ReadTask(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto numbers = ReadPair(text);
  if (!numbers) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--task {}: give TASK:ATTEMPT, the numbers of a task and of its attempt", OneLine(text)));
  }
  return TaskAttempt{.task = numbers->first, .attempt = numbers->second};
}

Expected<SegmentedReport> IndexVideo(const Indexer& indexer, const IndexJob& job, const Work& work,
                                     const WarningSink& warn) {
  if (work.cut_s) return indexer.IndexBySegments(job, *work.cut_s, Interrupt(), work.store, *work.segments, warn);
  SegmentedReport report;
  if (work.frames) {
    VICTORIOUS_ASSIGN_OR_RETURN(report.index,
                                indexer.IndexSegment(job, *work.frames, Interrupt(), work.store, *work.segments, warn));
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(report.index, indexer.Index(job, Interrupt(), work.store, warn));
  }
  return report;
}

// Warns of objects whose place was rejected: their telemetry may be of another flight.
Status WarnOfRejectedPlaces(IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects({}));
  const auto rejected = [](const ObjectRecord& object) { return !object.place_rejected.empty(); };
  const auto first = std::ranges::find_if(objects, rejected);
  if (first == objects.end()) return {};
  LogWarning(
      "{} of {} objects in the index have no place, although there is telemetry (the first: {}): it may belong "
      "to another flight or have a wrong clock; `victorious search` lists the reasons",
      std::ranges::count_if(objects, rejected), objects.size(), first->place_rejected);
  return {};
}

// @return null: the processor computes
// Errors: kUnsupported if a CUDA device was asked for, and there is none.
Expected<std::shared_ptr<kernels::NearestDevice>> OpenDevice(const IndexArguments& arguments) {
  const DeviceChoice choice = FromText(kDeviceTexts, arguments.device).value();
  if (choice == DeviceChoice::kCpu) return nullptr;
  std::string why_not;
  std::shared_ptr<kernels::NearestDevice> device = kernels::OpenNearestDevice(why_not);
  if (!device && choice == DeviceChoice::kCuda) {
    return Fail(ErrorCode::kUnsupported, fmt::format("--device cuda: {}; leave the option out, or give cpu", why_not));
  }
  return device;
}

// Warns of a device whose calls failed, when it goes.
class DeviceWarning {
 public:
  explicit DeviceWarning(const kernels::NearestDevice* device) : device_(device) {}
  DeviceWarning(const DeviceWarning&) = delete;
  DeviceWarning& operator=(const DeviceWarning&) = delete;
  ~DeviceWarning() {
    const auto failed = static_cast<std::int64_t>(device_ == nullptr ? 0 : device_->failed_calls());
    if (failed == 0) return;
    LogWarning("{}: {} failed ({}): the processor did the work, with the same results", device_->name(),
               CountText(failed, "call"), device_->last_error());
  }

 private:
  const kernels::NearestDevice* device_;  // null: none
};

Status Run(const IndexArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(
      CheckOutputs(parser, {{"--db", arguments.db, {}}, {"--draw", arguments.draw, FileKind::kVideo}}));
  VICTORIOUS_RETURN_IF_ERROR(CheckDrawnVideo(arguments.draw));
  VICTORIOUS_RETURN_IF_ERROR(CheckArguments(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<FrameInterval> frames, ParseFrames(arguments.frames));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<TaskAttempt> task, ReadTask(arguments.task));
  std::vector<ObjectModel> models;
  if (!arguments.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(models, ModelLibrary(arguments.models).LoadAll());
    if (models.empty()) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("{}: no models: first make one of photos or a CAD file (`victorious model add`)",
                              arguments.models));
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexOptions options, ReadOptions(arguments, models));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const RelitTemplateFolder> relit_folder,
                              OpenRelitTemplates(arguments.cache));
  // Videos of one flight have the same sun.
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates;
  if (arguments.videos.size() > 1) {
    VICTORIOUS_ASSIGN_OR_RETURN(relit_templates, MakeRelitViews(models, relit_folder.get()));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<CategorySourceInput> categories, ReadCategories(arguments));
  std::optional<std::int64_t> last_listed;
  std::string listed;
  if (const auto* list = categories ? std::get_if<DetectionList>(&*categories) : nullptr) {
    if (!list->frames.empty()) last_listed = list->frames.rbegin()->first;
    listed =
        fmt::format("{} in {}", CountText(list->CountBoxes(), "detection"), CountText(list->frames.size(), "frame"));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer,
                              Indexer::Create(std::move(models), options, std::move(categories),
                                              [](const std::string& warning) { LogWarning(warning); }));
  if (!listed.empty()) LogInfo("{}: {}", OneLine(arguments.list.file), listed);
  // Before anything is stored: another model of the same name would delete the results of this one in all videos.
  if (!arguments.targets.empty()) VICTORIOUS_RETURN_IF_ERROR(CheckTargets(arguments.targets, indexer.targets()));
  // A video that cannot be searched does not prevent the others from being indexed. Without any, no index is created.
  const std::map<std::string, Error> unsearchable = FindUnsearchable(arguments.videos, arguments.job.from_s);
  std::optional<Error> failure;
  for (const auto& [video, error] : unsearchable) failure = CombineErrors(failure, error);
  const auto can_be_searched = [&](const std::string& video) { return !unsearchable.contains(video); };
  if (std::ranges::none_of(arguments.videos, can_be_searched)) return std::unexpected(*std::move(failure));
  for (const auto& [video, error] : unsearchable) LogWarning("left out: {}", OneLine(error.message));
  // Read here although the search reads it again: a wrong file leaves no new index.
  if (arguments.job.telemetry) VICTORIOUS_RETURN_IF_ERROR(ReadTelemetry(*arguments.job.telemetry, options.telemetry));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<kernels::NearestDevice> device, OpenDevice(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store,
                              OpenStore(arguments.db, StoreMode::kCreate, task));
  std::unique_ptr<SegmentStore> segments;
  if (arguments.cut_s || frames) {
    VICTORIOUS_ASSIGN_OR_RETURN(segments, OpenPostgresSegmentStore(arguments.db, StoreMode::kCreate, task));
  }
  const DeviceWarning device_warning(device.get());
  IndexJob job = arguments.job;
  job.roots = RootsOf(arguments.files_below);
  job.redo = RedoOf(arguments);
  job.frame_budget =
      arguments.budget_ms.transform([](double ms) { return std::chrono::duration<double, std::milli>(ms); });
  job.relit_templates = std::move(relit_templates);
  job.relit_folder = relit_folder.get();
  job.device = device;
  const Work work{.store = *store, .segments = segments.get(), .cut_s = arguments.cut_s, .frames = frames};
  for (const std::string& video : arguments.videos) {
    if (!can_be_searched(video)) continue;
    const auto warn = [&](const std::string& warning) { LogWarning("{}: {}", video, warning); };
    job.video = video;
    job.inform = [&](const std::string& text) { LogInfo("{}: {}", OneLine(video), text); };
    if (arguments.json) MeasureStages(true);
    const Expected<SegmentedReport> report = IndexVideo(indexer, job, work, warn);
    if (!report && report.error().code == ErrorCode::kConflict) {
      LogInfo("{}; the video is left to it", OneLine(report.error().message));
      ReportEvent(VideoLeftEvent{video});
      continue;
    }
    if (!report) {
      failure = CombineErrors(failure, report.error());
      if (report.error().code == ErrorCode::kCancelled) break;
      continue;
    }
    if (report->waits_for) {
      LogInfo("{}: cut into segments, which are to be searched first", OneLine(video));
      ReportEvent(VideoCutEvent{video, *report->waits_for});
      return {};
    }
    LogReport(video, report->index);
    if (arguments.json) VICTORIOUS_RETURN_IF_ERROR(WriteOutput("", DumpJson(ToJson(video, report->index)) + "\n"));
  }
  if (failure) return std::unexpected(*std::move(failure));
  if (last_listed) VICTORIOUS_RETURN_IF_ERROR(WarnOfLaterDetections(job.StoredName(), *last_listed, *store));
  if (device) LogInfo("descriptors were compared on {}", device->name());
  if (!arguments.draw.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const IndexedDrawing drawing,
                                ListIndexedDrawing({.video_name = arguments.videos.front()}, *store));
    VICTORIOUS_RETURN_IF_ERROR(DrawVideo(drawing.video, drawing.sightings,
                                         {.folder_frame_rate = options.video.folder_frame_rate}, arguments.draw,
                                         Interrupt()));
  }
  return frames ? Status() : WarnOfRejectedPlaces(*store);
}

}  // namespace

Action SetUpIndex(ArgumentParser& parser) {
  const auto arguments = std::make_shared<IndexArguments>();
  parser.Add("VIDEO", arguments->videos, "Files, folders of frames, or live URLs").Required();
  parser.Add("--models", arguments->models, "Folder of models to search for").TypeName("DIR");
  parser
      .Add("--categories", arguments->categories,
           "A category model (`victorious category train`) or a detector (`category import`), whose categories are "
           "searched for as well")
      .TypeName("FILE");
  AddDetections(parser, arguments->list);
  AddDb(parser, arguments->db, "The index; created if it does not exist");
  parser
      .Add("--telemetry", arguments->job.telemetry,
           "Camera states (default: the file given for the video before, else its own KLV, or NAME.SRT or "
           "NAME.telemetry.csv beside it)")
      .TypeName("FILE");
  AddSearchSettings(parser, arguments->search);
  parser.Add("--from", arguments->job.from_s, "Search only from this video time on: seconds, or as 1:30 or 1:02:03.5")
      .TypeName("TIME")
      .Transform(&NormalizeVideoTime);
  parser.Add("--to", arguments->job.to_s, "Search only up to this video time")
      .TypeName("TIME")
      .Transform(&NormalizeVideoTime);
  parser
      .Add(
          "--budget-ms", arguments->budget_ms,
          "Time that the search may take a frame, on average: full searches are left out to hold it, and found objects "
          "tracked in between. What is found then depends on the machine. 33: as fast as 30 frames a second play")
      .Range(0.001, 1e6)
      .TypeName("MS");
  parser
      .Add("--keep-features", arguments->keep_features,
           "Seconds between the frames whose features are kept for `search --image` (default 1), or none")
      .TypeName("SECONDS");
  parser
      .Add("--cache", arguments->cache,
           "Folder where later searches find what this one made of the models for the sun's direction (default: "
           "victorious/templates in $XDG_CACHE_HOME or ~/.cache), or none")
      .TypeName("DIR");
  parser
      .Add("--device", arguments->device,
           "What compares descriptors, with the same results: a CUDA device (cuda), the processor (cpu), or the first "
           "if the machine and the program have it (auto, the default)")
      .OneOf(kDeviceTexts)
      .TypeName("DEVICE");
  parser
      .Add("--cut", arguments->cut_s,
           "For workers: cut a long video into segments of so many seconds and end; once they are searched, join them")
      .Range(0.001, 1e6)
      .TypeName("SECONDS");
  parser.Add("--frames", arguments->frames, "For workers: search only this segment, which --cut made")
      .TypeName("FROM:TO");
  parser.Add("--task", arguments->task, "For workers: write only while this attempt at a task runs")
      .TypeName("TASK:ATTEMPT");
  parser
      .Add("--targets", arguments->targets, "For workers: the content ids by name of what --models must have, as JSON")
      .TypeName("JSON");
  parser.Add("--stored-as", arguments->job.name, "For workers: the name under which the index has the video")
      .TypeName("PATH");
  parser
      .Add("--content-id", arguments->job.content_id,
           "For workers: refuse a video with another content than the one submitted")
      .TypeName("HASH");
  parser
      .Add("--covers", arguments->job.covers,
           "For workers: the live source of which the video is a recording, made by `victorious record`")
      .TypeName("URL");
  parser.AddFlag("--redo-other", arguments->redo_other,
                 "For workers: as --redo, if the results were made with other parameters");
  AddFilesBelow(parser, arguments->files_below);
  AddFieldOfView(parser, arguments->hfov_deg);
  AddCamera(parser, arguments->camera);
  AddGround(parser, arguments->ground);
  parser.AddFlag("--redo", arguments->redo,
                 "Delete the results of these models and categories in these videos, and search again");
  parser.AddFlag("--json", arguments->json,
                 "Print one JSON object per video: frames searched, sightings, sun, processor time of each stage");
  parser.Add("--threads", arguments->job.threads, "Number of threads; 0: one per processor")
      .Range(0, 1024)
      .TypeName("N");
  parser
      .Add("--draw", arguments->draw,
           "Write a copy of the video with the sightings, names and places drawn into it (.mp4, .mkv)")
      .TypeName("FILE");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
