#include "victorious/jobs/index/indexer.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <ranges>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/base/absolute_path.h"
#include "victorious/base/check.h"
#include "victorious/base/credentials.h"
#include "victorious/base/json.h"
#include "victorious/base/progress.h"
#include "victorious/base/stage_time.h"
#include "victorious/base/version.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/input/video/stream_recorder.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/indexer_parts.h"
#include "victorious/jobs/index/shape_background.h"
#include "victorious/jobs/index/shown_ground.h"
#include "victorious/jobs/model_engine.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/associate/update_objects.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/place/cameras/clock_offset.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/search/recognize/common_view.h"

namespace victorious {
namespace {

// What a user sets it by: a parameter's name ("match.ratio"), or the flag of the interval of time.
// @param key  a JSON pointer
std::string NameOfParameter(const std::string& key) {
  if (key == "/searched/from_s") return "--from";
  if (key == "/searched/to_s") return "--to";
  if (key == "/searched/budget_ms") return "--budget-ms";
  std::string name = key.substr(1);
  std::ranges::replace(name, '/', '.');
  return name;
}

// The parameters of a search that began before, and those of now, each as a JSON pointer with its value.
struct ComparedParameters {
  nlohmann::json before;
  nlohmann::json now;
};

// What the program did not have when the search began is what it is by default. std::nullopt for what is not JSON.
std::optional<ComparedParameters> Compare(const std::string& before, const std::string& now,
                                          const std::string& defaults) {
  const Expected<nlohmann::json> stored = ParseStrictJson(before);
  const Expected<nlohmann::json> wanted = ParseStrictJson(now);
  const Expected<nlohmann::json> unset = ParseStrictJson(defaults);
  if (!stored || !wanted || !unset || !stored->is_object() || !wanted->is_object() || !unset->is_object())
    return std::nullopt;
  nlohmann::json began_with = unset->flatten();
  began_with.update(stored->flatten());
  return ComparedParameters{.before = std::move(began_with), .now = wanted->flatten()};
}

// Lists the parameters that differ, with both values.
std::string DescribeDifference(const std::optional<ComparedParameters>& compared) {
  constexpr std::string_view kUnknown = "another version's parameters";
  if (!compared) return std::string(kUnknown);
  std::vector<std::string> changes;
  auto keys = compared->before;
  keys.update(compared->now);
  for (const auto& [key, unused] : keys.items()) {
    const auto old = compared->before.value(key, nlohmann::json());
    const auto value = compared->now.value(key, nlohmann::json());
    if (old == value) continue;
    const std::string name = NameOfParameter(key);
    const std::string absent = name.starts_with("--") ? "not given" : "null";
    const auto text = [&](const nlohmann::json& one) { return one.is_null() ? absent : DumpJson(one); };
    changes.push_back(fmt::format("{} was {}, is {}", name, text(old), text(value)));
  }
  return changes.empty() ? std::string(kUnknown) : fmt::format("{}", fmt::join(changes, "; "));
}

// The parameters as the store keeps them, as JSON.
struct StoredParameters {
  std::string models;      // of a search for models
  std::string categories;  // of a search for categories
  std::string features;

  [[nodiscard]] const std::string& Of(const ModelRecord& target) const {
    return target.IsCategory() ? categories : models;
  }
};

StoredParameters ParametersOf(const IndexOptions& options, const SearchIntervals& intervals, const IndexJob& job) {
  return {.models = SearchOptionsText(options, intervals.models, intervals.tracked, job),
          .categories = SearchOptionsText(options, intervals.categories, intervals.tracked, job),
          .features = OptionsToJsonText(MakeKeptFeatureOptions(options.features))};
}

// How the parameters of the first search that differs, of those that are sought, differ from those of now; empty: none
// does.
// @param defaults  what they are if nothing is set
Expected<std::string> FindDifference(const VideoRecord& video, const std::vector<ModelRecord>& sought,
                                     const StoredParameters& now, const StoredParameters& defaults, IndexStore& store) {
  const auto compare = [](const std::string& before, const std::string& wanted,
                          const std::string& unset) -> std::string {
    if (before.empty() || before == wanted) return "";
    const std::optional<ComparedParameters> compared = Compare(before, wanted, unset);
    return compared && compared->before == compared->now ? "" : DescribeDifference(compared);
  };
  std::string difference = compare(video.features_json, now.features, defaults.features);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> stored, store.Models());
  for (auto record = stored.begin(); difference.empty() && record != stored.end(); ++record) {
    const bool is_sought = std::ranges::any_of(sought, [&](const ModelRecord& one) {
      return one.name == record->name && one.content_id == record->content_id;  // other content is searched anew
    });
    if (!is_sought) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> before, store.FindSearch(video.id, record->id));
    if (before) difference = compare(before->options_json, now.Of(*record), defaults.Of(*record));
  }
  return difference;
}

// Whether frames were left out of the search for one of these because they killed who searched them.
Expected<bool> HasFailedParts(const VideoRecord& video, const std::vector<ModelRecord>& sought, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> parts, store.SearchParts(video.id));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> stored, store.Models());
  return std::ranges::any_of(parts, [&](const SearchPart& part) {
    if (part.kind != SearchPartKind::kFailed) return false;
    const auto model = std::ranges::find(stored, part.model, &ModelRecord::id);
    return model != stored.end() && std::ranges::find(sought, model->name, &ModelRecord::name) != sought.end();
  });
}

// The folder that a relative name is relative to; empty for absolute names and URLs.
std::string FolderOf(const std::string& name) {
  if (name.contains("://") || std::filesystem::path(name).is_absolute()) return "";
  std::error_code unknown;
  return std::filesystem::current_path(unknown).string();
}

// The telemetry file of the job, else the one that was given for the video before.
Expected<std::optional<std::string>> GivenTelemetry(const IndexJob& job, const std::string& content_id,
                                                    IndexStore& store, const WarningSink& warn) {
  if (job.telemetry) return job.telemetry;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoRecord> before, store.VideoOfContent(content_id));
  if (!before) return std::nullopt;
  const auto warn_of_loss = [&](const std::string& loss) {
    warn(loss + ": what is in the video or beside it is used, if there is any; --telemetry FILE names another file");
  };
  const std::optional<std::string> file = RememberedTelemetry(before->telemetry, job.roots, warn_of_loss);
  if (file && job.inform) job.inform(fmt::format("telemetry: {}, as it was given for the video before", *file));
  return file;
}

// The index identifies models and categories by name, so one would overwrite the other.
Status CheckNames(const std::vector<ModelRecord>& sought, const std::vector<ModelRecord>& others) {
  for (const ModelRecord& one : sought) {
    for (const ModelRecord& other : others) {
      if (one.name != other.name || one.IsCategory() == other.IsCategory()) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: is the name of both a model and a category: rename one of them", one.name));
    }
  }
  return {};
}

// Of a ground that was made: its options, and the size and time of its files.
std::string IdentifyGround(const GroundOptions& ground) {
  std::string id = OptionsToJsonText(ground);
  for (const std::string& file : {ground.terrain, ground.geoid_grid}) {
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    const auto time = std::filesystem::last_write_time(file, error);
    if (!file.empty() && !error) id += fmt::format(" {} {}", size, time.time_since_epoch().count());
  }
  return id;
}

void WarnIfChanged(const ModelRecord& target, const std::vector<ModelRecord>& models_before, const WarningSink& warn) {
  const bool changed = std::ranges::any_of(models_before, [&](const ModelRecord& before) {
    return before.name == target.name && before.content_id != target.content_id;
  });
  if (!changed) return;
  warn(fmt::format(
      "{} {} differs from the one searched for before: its earlier results, in other videos too, are dropped",
      target.IsCategory() ? "category" : "model", target.name));
}

}  // namespace

Expected<std::string> ContentIdOf(const VideoReader& reader, const std::string& video, const CancelToken& cancel) {
  constexpr std::int64_t kLongBytes = std::int64_t{256} << 20;
  constexpr std::int64_t kMegabyte = 1'000'000;
  std::optional<Progress> progress;
  return reader.ContentId(cancel, [&](std::int64_t done, std::int64_t total) {
    if (total < kLongBytes) return;
    if (!progress) progress.emplace(video + ", content id", total / kMegabyte, "MB");
    progress->Update(done / kMegabyte);
  });
}

std::string SearchOptionsText(IndexOptions options, int every, int tracked, const IndexJob& job) {
  options.every = every;
  options.follow = FollowOptionsOf(options.follow, tracked);
  FieldList fields;
  options.ListSearchFields(fields);
  std::string text = ToJsonText(fields.fields());
  if (!job.from_s && !job.to_s && !job.frame_budget) return text;
  nlohmann::json json = ParseStrictJson(text).value();
  if (job.from_s) json["searched"]["from_s"] = *job.from_s;
  if (job.to_s) json["searched"]["to_s"] = *job.to_s;
  if (job.frame_budget) json["searched"]["budget_ms"] = job.frame_budget->count();
  return DumpJson(json);
}

Indexer::Indexer(std::vector<ObjectModel> models, const IndexOptions& options,
                 std::unique_ptr<const FeatureExtractor> extractor,
                 std::unique_ptr<const FeatureExtractor> kept_extractor,
                 std::shared_ptr<const CategorySource> categories)
    : models_(std::make_shared<const std::vector<ObjectModel>>(std::move(models))),
      options_(options),
      extractor_(std::move(extractor)),
      kept_extractor_(std::move(kept_extractor)),
      categories_(std::move(categories)) {
  for (const ObjectModel& model : *models_)
    targets_.push_back({.name = model.name, .content_id = model.id, .kind = model.kind});
  if (!categories_) return;
  for (const std::string& name : categories_->names())
    targets_.push_back({.name = name, .content_id = categories_->content_id(), .kind = ModelKind::kCategory});
}

Expected<Indexer> Indexer::Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                  std::optional<CategorySourceModel> categories, const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  IndexOptions used = options;
  VICTORIOUS_RETURN_IF_ERROR(AdoptEngineOfModels(models, used.features, warn));
  VICTORIOUS_ASSIGN_OR_RETURN(auto extractor, MakeFeatureExtractor(used.features));
  VICTORIOUS_ASSIGN_OR_RETURN(auto kept_extractor, MakeFeatureExtractor(MakeKeptFeatureOptions(used.features)));
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<const Ground> ground, MakeGround(options.ground, warn));
  std::shared_ptr<const CategorySource> source;
  if (categories) {
    VICTORIOUS_ASSIGN_OR_RETURN(source,
                                MakeCategorySource(*std::move(categories), options.categories, options.detector));
    if (source->IsDetector()) used.category_interval_s = options.detector.interval_s;
  }
  Indexer indexer(std::move(models), used, std::move(extractor), std::move(kept_extractor), std::move(source));
  if (ground) indexer.options_.objects.ground_id = IdentifyGround(options.ground);
  indexer.options_.objects.ground = std::move(ground);
  VICTORIOUS_RETURN_IF_ERROR(CheckNames(indexer.targets_, indexer.targets_));
  return indexer;
}

Expected<bool> Indexer::IsRedone(const IndexJob& job, const VideoInfo& info, const std::string& content_id,
                                 IndexStore& store) const {
  if (job.redo == Redo::kAlways) return true;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoRecord> before, store.VideoOfContent(content_id));
  if (!before) return false;
  const SearchIntervals intervals = MakeSearchIntervals(options_, info);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string difference,
                              FindDifference(*before, targets_, ParametersOf(options_, intervals, job),
                                             ParametersOf({}, intervals, {}), store));
  if (difference.empty() && job.redo == Redo::kIfDifferent) return HasFailedParts(*before, targets_, store);
  if (difference.empty() || job.redo == Redo::kIfDifferent) return !difference.empty();
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "{}: was indexed with other parameters ({}): give the same parameters, or --redo to delete its results and "
          "search it again",
          WithoutCredentials(job.StoredName()), difference));
}

Expected<IndexReport> Indexer::Index(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                     const WarningSink& warn) const {
  const WarningSink emit_warning = warn ? warn : [](const std::string&) {};
  Expected<IndexReport> report = Search(job, cancel, store, emit_warning);
  if (report || report.error().code == ErrorCode::kCancelled) {
    VICTORIOUS_RETURN_IF_ERROR(UpdateObjectsOf(job, cancel, store, emit_warning));
  }
  return report;
}

Status Indexer::UpdateObjectsOf(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                const WarningSink& warn) const {
  const auto tell_of_own = [&](const VideoRecord& video, const FlightNotes& notes) {
    if (video.name != job.StoredName()) return;
    for (const std::string& warning : notes.warnings) warn(warning);
    if (!job.inform) return;
    for (const std::string& line : notes.telemetry_errors) job.inform("error of telemetry: " + line);
  };
  return UpdateObjects(options_.objects, store, cancel, tell_of_own);
}

Status Indexer::CheckNamesOf(const std::vector<ModelRecord>& models_before) const {
  return CheckNames(targets_, models_before);
}

Expected<IndexReport> Indexer::Search(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                      const WarningSink& warn) const {
  VICTORIOUS_CHECK(job.relit_templates.empty() || job.relit_templates.size() == models_->size());
  if (cancel.IsCancelled()) {
    return Fail(ErrorCode::kCancelled, fmt::format("{}: stopped before it was opened; run again to resume", job.video));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models_before, store.Models());
  VICTORIOUS_RETURN_IF_ERROR(CheckNamesOf(models_before));
  VICTORIOUS_ASSIGN_OR_RETURN(OpenedVideo video, OpenVideo(job, cancel, store, warn));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PlannedPass> plans, PlanPasses(job, video, models_before, store, warn));
  if (!plans.empty()) VICTORIOUS_RETURN_IF_ERROR(CorrectTelemetryOf(job, cancel, store, warn, video));
  IndexReport report{.has_telemetry = video.cameras.trajectory() != nullptr || video.reader->info().live};
  for (const PlannedPass& plan : plans) {
    VICTORIOUS_RETURN_IF_ERROR(RunPass(plan, job, video, cancel, store, warn, report));
  }
  return report;
}

// A folder with a frame rate of its own is left as it is: its motion is measured at the default one.
Status Indexer::CorrectTelemetryOf(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                   const WarningSink& warn, OpenedVideo& video) const {
  const bool is_given = options_.telemetry.time_offset_s != 0;
  const bool is_timed = options_.video.folder_frame_rate == VideoOptions().folder_frame_rate;
  if (is_given || !is_timed || video.reader->info().live) return {};
  VICTORIOUS_RETURN_IF_ERROR(CorrectTelemetry(job.video, options_.features.impulse_fraction,
                                              FindGiven(options_.telemetry), cancel, warn, video.cameras));
  if (video.cameras.start_utc_us() == video.record.start_utc_us) return {};
  VideoRecord corrected = video.record;
  corrected.start_utc_us = video.cameras.start_utc_us();
  VICTORIOUS_ASSIGN_OR_RETURN(video.record, store.PutVideo(corrected));
  return {};
}

VideoReaderOptions Indexer::MakeReaderOptions(const IndexJob& job) const {
  const bool needs_color = categories_ && categories_->IsDetector();
  return {.color = needs_color ? FrameColor::kGreyAndBgr : FrameColor::kGrey,
          .data_packets = true,  // a live source sends them once
          .threads = job.threads,
          .folder_frame_rate = options_.video.folder_frame_rate};
}

Expected<Indexer::OpenedVideo> Indexer::OpenVideo(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                                  const WarningSink& warn) const {
  OpenedVideo video;
  VICTORIOUS_ASSIGN_OR_RETURN(video.reader, VideoReader::Open(job.video, MakeReaderOptions(job)));
  const VideoInfo& info = video.reader->info();
  video.intervals = MakeSearchIntervals(options_, info);
  VICTORIOUS_ASSIGN_OR_RETURN(std::string content_id, ContentIdOf(*video.reader, job.video, cancel));
  if (!job.content_id.empty() && content_id != job.content_id) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: not the video that was submitted: put that one back, or submit this one", job.video));
  }
  if (!job.covers.empty()) content_id += fmt::format(" from {:.6f} s", job.from_s.value_or(0));
  VICTORIOUS_ASSIGN_OR_RETURN(video.is_redone, IsRedone(job, info, content_id, store));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::string> telemetry, GivenTelemetry(job, content_id, store, warn));
  VICTORIOUS_ASSIGN_OR_RETURN(video.cameras, CameraStates::Load(job.video, info, telemetry, options_.telemetry,
                                                                "nothing will get a place", warn));
  if (options_.objects.ground && video.cameras.HasStates()) {
    const auto underground = DescribeUnderground(video.cameras.trajectory()->states(), *options_.objects.ground);
    if (underground) warn("telemetry: " + *underground);
  }
  video.cameras.SetFallbackFieldOfView(GivenFieldOfView(options_.telemetry));
  if (!info.live && job.covers.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t forgotten,
                                store.DeleteOtherContent(job.StoredName(), FolderOf(job.StoredName()), content_id));
    if (forgotten > 0) warn("the video has changed since it was indexed: its earlier results are replaced");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(video.record, store.PutVideo({.content_id = content_id,
                                                            .name = job.StoredName(),
                                                            .folder = FolderOf(job.StoredName()),
                                                            .width = info.width,
                                                            .height = info.height,
                                                            .frame_count = {},
                                                            .duration_s = {},
                                                            .start_utc_us = video.cameras.start_utc_us(),
                                                            .is_of_photos = video.cameras.is_of_photos(),
                                                            .telemetry = AbsolutePath(job.telemetry.value_or("")),
                                                            .features_json = {}}));
  const CameraTrajectory* const path = video.cameras.trajectory();
  VICTORIOUS_RETURN_IF_ERROR(store.PutShownGround(
      video.record.id, path == nullptr ? std::vector<GeoBox>() : ShownGround(path->states(), info.width, info.height)));
  return video;
}

Expected<std::vector<Indexer::PlannedPass>> Indexer::PlanPasses(const IndexJob& job, const OpenedVideo& video,
                                                                const std::vector<ModelRecord>& models_before,
                                                                IndexStore& store, const WarningSink& warn) const {
  const StoredParameters parameters = ParametersOf(options_, video.intervals, job);
  // The frames to be kept, and their features, may now be others.
  if (video.is_redone) VICTORIOUS_RETURN_IF_ERROR(store.DeleteKeptFrames(video.record.id));
  std::map<std::int64_t, PlannedPass> passes;  // by first frame
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const ModelRecord& target = targets_[t];
    WarnIfChanged(target, models_before, warn);
    VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord stored, store.PutModel(target));
    if (video.is_redone) VICTORIOUS_RETURN_IF_ERROR(store.DeleteSearch(video.record.id, stored.id));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> before, store.FindSearch(video.record.id, stored.id));
    if (before && before->finished) continue;
    const std::int64_t next_frame = before ? before->next_frame : 0;
    passes[next_frame].targets.push_back(t);
    passes[next_frame].searches.push_back({.video = video.record.id,
                                           .model = stored.id,
                                           .next_frame = next_frame,
                                           .finished = false,
                                           .options_json = parameters.Of(target),
                                           .program_version = kVersion});
  }
  VICTORIOUS_RETURN_IF_ERROR(store.SetVideoFeatures(video.record.id, parameters.features));
  const auto plans = std::views::values(passes);
  return std::vector<PlannedPass>(plans.begin(), plans.end());
}

std::shared_ptr<const std::vector<ObjectModel>> Indexer::SearchedModels(const PlannedPass& plan) const {
  const auto is_model = [this](std::size_t target) { return target < models_->size(); };  // else a category
  if (std::ranges::count_if(plan.targets, is_model) == std::ssize(*models_)) return models_;
  std::vector<ObjectModel> some;
  for (const std::size_t target : plan.targets | std::views::filter(is_model)) some.push_back((*models_)[target]);
  return std::make_shared<const std::vector<ObjectModel>>(std::move(some));
}

Expected<Recognizer> Indexer::MakeRecognizer(const PlannedPass& plan, const IndexJob& job) const {
  const std::shared_ptr<const std::vector<ObjectModel>> models = SearchedModels(plan);
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates;
  if (job.relit_templates.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(relit_templates, MakeRelitViews(*models, job.relit_folder));
  } else {
    for (const std::size_t target : plan.targets) {
      if (target < models_->size()) relit_templates.push_back(job.relit_templates[target]);
    }
  }
  return Recognizer::Create(models, options_.features.engine, options_.recognize, relit_templates, job.device);
}

std::vector<std::optional<std::int64_t>> Indexer::CategoryIds(const PlannedPass& plan) const {
  std::vector<std::optional<std::int64_t>> ids(targets_.size() - models_->size());
  for (std::size_t i = 0; i < plan.targets.size(); ++i) {
    if (plan.targets[i] >= models_->size()) ids[plan.targets[i] - models_->size()] = plan.searches[i].model;
  }
  return ids;
}

// A pass that keeps a pace is not repeatable anyway: its tracks need not restart for a resumed one to equal it. Its
// searches of full frames lie seconds apart.
FollowOptions Indexer::MakeFollowOptions(const IndexJob& job, const OpenedVideo& video) const {
  constexpr int kBackwardFrames = 90;
  FollowOptions follow = FollowOptionsOf(options_.follow, video.intervals.tracked);
  if (!job.frame_budget && !(video.reader && video.reader->info().live)) return follow;
  follow.restart_interval_frames = kNoRestart;
  follow.backward_frames = std::max(follow.backward_frames, kBackwardFrames);
  return follow;
}

IndexPass Indexer::MakePass(const PlannedPass& plan, const Recognizer& recognizer,
                            std::span<const std::optional<std::int64_t>> category_ids, const IndexJob& job,
                            OpenedVideo& video) const {
  const bool with_categories = plan.searches.size() > recognizer.models().size();
  return {.video = video.record,
          .searches = plan.searches,
          .recognizer = recognizer,
          .categories = with_categories ? categories_.get() : nullptr,
          .category_ids = category_ids,
          .extractor = *extractor_,
          .kept_extractor = *kept_extractor_,
          .options = options_,
          .follow = MakeFollowOptions(job, video),
          .intervals = video.intervals,
          .cameras = video.cameras,
          .sun = {},
          .threads = job.threads,
          .from_s = job.from_s,
          .to_s = job.to_s,
          .frame_budget = job.frame_budget,
          .source = video.reader && video.reader->info().live ? job.StoredName() : job.covers,
          .recorded_utc_us = job.covers.empty() ? std::nullopt : RecordingStart(job.video),
          .file = job.video,
          .inform = job.inform};
}

Expected<std::unique_ptr<const ShapeSearch>> Indexer::MakeShapeSearch(const Recognizer& recognizer, const IndexJob& job,
                                                                      const CameraStates& cameras,
                                                                      const VideoInfo& info,
                                                                      const CancelToken& cancel) const {
  const bool has_camera = (cameras.ground_height() || options_.objects.ground) && HasAttitudes(cameras.trajectory());
  const auto can_be_drawn =
      std::ranges::count_if(recognizer.relit_templates(), [](const auto& surfaces) { return surfaces != nullptr; });
  if (!options_.shape.enabled || info.live || can_be_drawn == 0) return nullptr;
  const StageScope scope(Stage::kShape);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::vector<cv::Mat> frames,
      ReadSpreadFrames(job.video, info.duration_s.value_or(0), has_camera ? kBackgroundFrames : kViewFrames,
                       options_.features.impulse_fraction, cancel));
  if (frames.empty()) return nullptr;
  auto shapes = std::make_unique<ShapeSearch>(recognizer.models(), recognizer.relit_templates(), BackgroundOf(frames));
  if (has_camera) return shapes;
  if (can_be_drawn < kModelsOfCommonView) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_found, shapes->SearchByContours(frames, cancel));
    if (!is_found) return nullptr;
    return shapes;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<CommonView> view, EstimateCommonView(*shapes, frames, cancel));
  if (!view) return nullptr;
  if (job.inform) {
    job.inform(
        fmt::format("the camera's height is unknown; for the search by shape, {:.3g} pixels a metre and an "
                    "off-nadir angle of {:.0f} degrees are assumed, in which the objects of several models agree",
                    view->pixels_per_m, DegreesFromRadians(view->off_nadir_rad)));
  }
  shapes->AssumeCamera(ConditionsOf(*view, frames.front().size()));
  return shapes;
}

Status Indexer::RunPass(const PlannedPass& plan, const IndexJob& job, OpenedVideo& video, const CancelToken& cancel,
                        IndexStore& store, const WarningSink& warn, IndexReport& report) const {
  if (!video.reader) {
    VICTORIOUS_ASSIGN_OR_RETURN(video.reader, VideoReader::Open(job.video, MakeReaderOptions(job)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer, MakeRecognizer(plan, job));
  VICTORIOUS_RETURN_IF_ERROR(EstimateSun(recognizer, job, video, cancel, warn, report));
  const std::vector<std::optional<std::int64_t>> category_ids = CategoryIds(plan);
  IndexPass pass = MakePass(plan, recognizer, category_ids, job, video);
  pass.sun = report.sun;
  pass.duration_s = video.reader->info().duration_s;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<const ShapeSearch> shapes,
                              MakeShapeSearch(recognizer, job, video.cameras, video.reader->info(), cancel));
  pass.shapes = shapes.get();
  VICTORIOUS_RETURN_IF_ERROR(RunIndexPass(pass, *video.reader, cancel, store, warn, report));
  video.reader.reset();
  return {};
}

}  // namespace victorious
