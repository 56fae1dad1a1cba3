#include "victorious/jobs/index/index_run.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <ranges>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/absolute_path.h"
#include "victorious/base/check.h"
#include "victorious/base/credentials.h"
#include "victorious/base/progress.h"
#include "victorious/base/stage_time.h"
#include "victorious/base/version.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/input/video/stream_recorder.h"
#include "victorious/jobs/index/search_scale.h"
#include "victorious/jobs/index/shape_background.h"
#include "victorious/jobs/index/shown_ground.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/calibrate/assumed_attitude.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/place/cameras/clock_offset.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/search/recognize/common_view.h"

namespace victorious {
namespace {

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

void WarnIfChanged(const ModelRecord& target, const std::vector<ModelRecord>& models_before, const WarningSink& warn) {
  const bool changed = std::ranges::any_of(models_before, [&](const ModelRecord& before) {
    return before.name == target.name && before.content_id != target.content_id;
  });
  if (!changed) return;
  warn(fmt::format(
      "{} {} differs from the one searched for before: its earlier results, in other videos too, are dropped",
      target.IsCategory() ? "category" : "model", target.name));
}

// True if the camera's attitude is known at some time. @param trajectory  null: there is no telemetry
bool HasAttitudes(const CameraTrajectory* trajectory) {
  return trajectory != nullptr &&
         std::ranges::any_of(trajectory->states(), [](const CameraState& state) { return state.attitude.has_value(); });
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

Expected<bool> IsRedone(const IndexSetup& setup, const IndexJob& job, const VideoInfo& info,
                        const std::string& content_id, IndexStore& store) {
  if (job.redo == Redo::kAlways) return true;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoRecord> before, store.VideoOfContent(content_id));
  if (!before) return false;
  const SearchIntervals intervals = MakeSearchIntervals(setup.options, info);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string difference,
                              FindDifference(*before, setup.targets, ParametersOf(setup.options, intervals, job),
                                             ParametersOf({}, intervals, {}), store));
  if (difference.empty() && job.redo == Redo::kIfDifferent) return HasFailedParts(*before, setup.targets, store);
  if (difference.empty() || job.redo == Redo::kIfDifferent) return !difference.empty();
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "{}: was indexed with other parameters ({}): give the same parameters, or --redo to delete its results and "
          "search it again",
          WithoutCredentials(job.StoredName()), difference));
}

IndexRun::IndexRun(const IndexSetup& setup, const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                   const WarningSink& warn)
    : setup_(setup), job_(job), cancel_(cancel), store_(store), warn_(warn) {
  VICTORIOUS_CHECK(job.relit_templates.empty() || job.relit_templates.size() == setup.models->size());
}

Status IndexRun::Open() {
  VICTORIOUS_ASSIGN_OR_RETURN(models_before_, store_.Models());
  VICTORIOUS_RETURN_IF_ERROR(CheckNames(setup_.targets, models_before_));
  VICTORIOUS_ASSIGN_OR_RETURN(video_.reader, VideoReader::Open(job_.video, ReaderOptions()));
  const VideoInfo& info = video_.reader->info();
  video_.intervals = MakeSearchIntervals(setup_.options, info);
  if (setup_.EntersList() && info.live) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a live source: detections are entered for a file", WithoutCredentials(job_.video)));
  }
  video_.follow = FollowOptionsFor(video_.intervals.tracked, info.live);
  VICTORIOUS_ASSIGN_OR_RETURN(std::string content_id, ContentIdOf(*video_.reader, job_.video, cancel_));
  if (!job_.content_id.empty() && content_id != job_.content_id) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: not the video that was submitted: put that one back, or submit this one", job_.video));
  }
  if (!job_.covers.empty()) content_id += fmt::format(" from {:.6f} s", job_.from_s.value_or(0));
  VICTORIOUS_ASSIGN_OR_RETURN(video_.is_redone, IsRedone(setup_, job_, info, content_id, store_));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::string> telemetry,
                              GivenTelemetry(job_, content_id, store_, warn_));
  VICTORIOUS_ASSIGN_OR_RETURN(video_.cameras, CameraStates::Load(job_.video, info, telemetry, setup_.options.telemetry,
                                                                 "nothing will get a place", warn_));
  if (setup_.options.objects.ground && video_.cameras.HasStates()) {
    const auto underground = DescribeUnderground(video_.cameras.trajectory()->states(), *setup_.options.objects.ground);
    if (underground) warn_("telemetry: " + *underground);
  }
  video_.cameras.SetFallbackFieldOfView(GivenFieldOfView(setup_.options.telemetry));
  video_.record = {.content_id = content_id,
                   .name = job_.StoredName(),
                   .folder = FolderOf(job_.StoredName()),
                   .width = info.width,
                   .height = info.height,
                   .frame_count = {},
                   .duration_s = {},
                   .start_utc_us = {},
                   .is_of_photos = video_.cameras.is_of_photos(),
                   .telemetry = AbsolutePath(job_.telemetry.value_or("")),
                   .features_json = {}};
  report_.has_telemetry = video_.cameras.trajectory() != nullptr || info.live;
  return {};
}

Expected<std::vector<PlannedPass>> IndexRun::Plan() {
  parameters_ = ParametersOf(setup_.options, video_.intervals, job_);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoRecord> stored_video,
                              store_.VideoOfContent(video_.record.content_id));
  std::map<std::int64_t, PlannedPass> passes;  // by first frame
  for (std::size_t t = 0; t < setup_.targets.size(); ++t) {
    const ModelRecord& target = setup_.targets[t];
    const ModelRecord* const stored = FindSame(models_before_, target);
    std::optional<SearchRecord> before;
    if (stored_video && stored != nullptr && !video_.is_redone) {
      VICTORIOUS_ASSIGN_OR_RETURN(before, store_.FindSearch(stored_video->id, stored->id));
    }
    if (before && before->finished) continue;
    const std::int64_t next_frame = before ? before->next_frame : 0;
    passes[next_frame].targets.push_back(t);
    passes[next_frame].searches.push_back({.video = 0,
                                           .model = 0,
                                           .next_frame = next_frame,
                                           .finished = false,
                                           .options_json = parameters_.Of(target),
                                           .program_version = kVersion});
  }
  if (!passes.empty()) VICTORIOUS_RETURN_IF_ERROR(CorrectClock());
  const auto plans = std::views::values(passes);
  return std::vector<PlannedPass>(plans.begin(), plans.end());
}

// A folder with a frame rate of its own is left as it is: its motion is measured at the default one.
Status IndexRun::CorrectClock() {
  const bool is_given = setup_.options.telemetry.time_offset_s != 0;
  const bool is_timed = setup_.options.video.folder_frame_rate == VideoOptions().folder_frame_rate;
  if (is_given || !is_timed || video_.reader->info().live) return {};
  return CorrectTelemetry(job_.video, setup_.options.features.impulse_fraction, FindGiven(setup_.options.telemetry),
                          cancel_, warn_, video_.cameras);
}

Status IndexRun::Begin(std::vector<PlannedPass>& plan) {
  VideoRecord& record = video_.record;
  if (!video_.reader->info().live && job_.covers.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t forgotten,
                                store_.DeleteOtherContent(record.name, record.folder, record.content_id));
    if (forgotten > 0) warn_("the video has changed since it was indexed: its earlier results are replaced");
  }
  record.start_utc_us = video_.cameras.start_utc_us();
  VICTORIOUS_ASSIGN_OR_RETURN(record, store_.PutVideo(record));
  const CameraTrajectory* const path = video_.cameras.trajectory();
  VICTORIOUS_RETURN_IF_ERROR(store_.PutShownGround(
      record.id, path == nullptr ? std::vector<GeoBox>() : ShownGround(path->states(), record.width, record.height)));
  // The frames to be kept, and their features, may now be others.
  const bool keeps_features = !setup_.EntersList();
  if (video_.is_redone && keeps_features) VICTORIOUS_RETURN_IF_ERROR(store_.DeleteKeptFrames(record.id));
  if (setup_.EntersList()) VICTORIOUS_RETURN_IF_ERROR(DeleteListedBefore());
  std::vector<std::int64_t> ids;
  for (const ModelRecord& target : setup_.targets) {
    WarnIfChanged(target, models_before_, warn_);
    VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord stored, store_.PutModel(target));
    if (video_.is_redone) VICTORIOUS_RETURN_IF_ERROR(store_.DeleteSearch(record.id, stored.id));
    ids.push_back(stored.id);
  }
  for (PlannedPass& pass : plan) {
    for (std::size_t i = 0; i < pass.targets.size(); ++i) {
      pass.searches[i].video = record.id;
      pass.searches[i].model = ids[pass.targets[i]];
    }
  }
  return keeps_features ? store_.SetVideoFeatures(record.id, parameters_.features) : Status();
}

// Deletes the results of this detector's earlier list, of all its classes.
Status IndexRun::DeleteListedBefore() {
  for (const ModelRecord& before : models_before_) {
    if (!before.IsCategory() || before.content_id != setup_.categories->content_id()) continue;
    VICTORIOUS_RETURN_IF_ERROR(store_.DeleteSearch(video_.record.id, before.id));
  }
  return {};
}

Expected<IndexReport> IndexRun::Search() {
  if (cancel_.IsCancelled()) {
    return Fail(ErrorCode::kCancelled,
                fmt::format("{}: stopped before it was opened; run again to resume", job_.video));
  }
  VICTORIOUS_RETURN_IF_ERROR(Open());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<PlannedPass> plan, Plan());
  VICTORIOUS_RETURN_IF_ERROR(Begin(plan));
  for (const PlannedPass& pass : plan) VICTORIOUS_RETURN_IF_ERROR(SearchPass(pass));
  return report_;
}

std::shared_ptr<const std::vector<ObjectModel>> IndexRun::SearchedModels(const PlannedPass& plan) const {
  const auto is_model = [this](std::size_t target) { return setup_.IsModel(target); };
  if (std::ranges::count_if(plan.targets, is_model) == std::ssize(*setup_.models)) return setup_.models;
  std::vector<ObjectModel> some;
  for (const std::size_t target : plan.targets | std::views::filter(is_model)) some.push_back((*setup_.models)[target]);
  return std::make_shared<const std::vector<ObjectModel>>(std::move(some));
}

Expected<Recognizer> IndexRun::MakeRecognizer(const PlannedPass& plan) const {
  const std::shared_ptr<const std::vector<ObjectModel>> models = SearchedModels(plan);
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates;
  if (job_.relit_templates.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(relit_templates, MakeRelitViews(*models, job_.relit_folder));
  } else {
    for (const std::size_t target : plan.targets) {
      if (setup_.IsModel(target)) relit_templates.push_back(job_.relit_templates[target]);
    }
  }
  return Recognizer::Create(models, setup_.options.features.engine, setup_.options.recognize, relit_templates,
                            job_.device);
}

std::vector<std::optional<std::int64_t>> IndexRun::CategoryIds(const PlannedPass& plan) const {
  std::vector<std::optional<std::int64_t>> ids(setup_.targets.size() - setup_.models->size());
  for (std::size_t i = 0; i < plan.targets.size(); ++i) {
    if (plan.targets[i] >= setup_.models->size()) ids[plan.targets[i] - setup_.models->size()] = plan.searches[i].model;
  }
  return ids;
}

// A pass that keeps a pace is not repeatable anyway: its tracks need not restart for a resumed one to equal it. Its
// searches of full frames lie seconds apart.
FollowOptions IndexRun::FollowOptionsFor(int tracked, bool is_live) const {
  constexpr int kBackwardFrames = 90;
  FollowOptions follow = FollowOptionsOf(setup_.options.follow, tracked);
  if (!job_.frame_budget && !is_live) return follow;
  follow.restart_interval_frames = kNoRestart;
  follow.backward_frames = std::max(follow.backward_frames, kBackwardFrames);
  return follow;
}

IndexPass IndexRun::MakePass(const PlannedPass& plan, const Recognizer& recognizer,
                             std::span<const std::optional<std::int64_t>> category_ids, OpenedVideo& video) const {
  const bool with_categories = plan.searches.size() > recognizer.models().size();
  return {.job = job_,
          .video = video.record,
          .searches = plan.searches,
          .recognizer = recognizer,
          .categories = with_categories ? setup_.categories.get() : nullptr,
          .category_ids = category_ids,
          .extractor = *setup_.extractor,
          .kept_extractor = *setup_.kept_extractor,
          .options = setup_.options,
          .follow = video.follow,
          .intervals = video.intervals,
          .cameras = video.cameras,
          .source = video.reader && video.reader->info().live ? job_.StoredName() : job_.covers,
          .recorded_utc_us = job_.covers.empty() ? std::nullopt : RecordingStart(job_.video)};
}

Expected<std::unique_ptr<const ShapeSearch>> IndexRun::MakeShapeSearch(const Recognizer& recognizer,
                                                                       const CameraStates& cameras,
                                                                       const VideoInfo& info) const {
  const bool has_camera =
      (cameras.ground_height() || setup_.options.objects.ground) && HasAttitudes(cameras.trajectory());
  const auto can_be_drawn =
      std::ranges::count_if(recognizer.relit_templates(), [](const auto& surfaces) { return surfaces != nullptr; });
  if (!setup_.options.shape.enabled || info.live || can_be_drawn == 0) return nullptr;
  const StageScope scope(Stage::kShape);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::vector<cv::Mat> frames,
      ReadSpreadFrames(job_.video, info.duration_s.value_or(0), has_camera ? kBackgroundFrames : kViewFrames,
                       setup_.options.features.impulse_fraction, cancel_));
  if (frames.empty()) return nullptr;
  auto shapes = std::make_unique<ShapeSearch>(recognizer.models(), recognizer.relit_templates(), BackgroundOf(frames));
  if (has_camera) return shapes;
  if (can_be_drawn < kModelsOfCommonView) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_found, shapes->SearchByContours(frames, cancel_));
    if (!is_found) return nullptr;
    return shapes;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<CommonView> view, EstimateCommonView(*shapes, frames, cancel_));
  if (!view) return nullptr;
  if (job_.inform) {
    job_.inform(
        fmt::format("the camera's height is unknown; for the search by shape, {:.3g} pixels a metre and an "
                    "off-nadir angle of {:.0f} degrees are assumed, in which the objects of several models agree",
                    view->pixels_per_m, DegreesFromRadians(view->off_nadir_rad)));
  }
  shapes->AssumeCamera(ConditionsOf(*view, frames.front().size()));
  return shapes;
}

// The tilt is unknown: the first of these angles off nadir is taken at which the sun's direction is certain. Objects
// are searched for within 20 degrees of the vertical.
Status IndexRun::AssumeSun(const Recognizer& recognizer) {
  constexpr std::array kOffNadir_rad = {RadiansFromDegrees(45), RadiansFromDegrees(65)};
  constexpr double kMaxDuration_s = 60;  // the yaw drifts, and the tilt may change
  const VideoInfo& info = video_.reader->info();
  if (setup_.options.sun_direction.sun == SunSearch::kOff || !recognizer.HasRelitTemplates() || info.live ||
      video_.cameras.is_of_photos() || !info.duration_s || *info.duration_s > kMaxDuration_s) {
    return {};
  }
  const auto motions =
      MeasureMotions(job_.video, {.max_duration_s = kMaxDuration_s}, setup_.options.features.impulse_fraction, cancel_);
  if (!motions) {
    if (motions.error().code == ErrorCode::kCancelled) return std::unexpected(motions.error());
    return {};  // the search of the same video reports it
  }
  for (const double off_nadir_rad : kOffNadir_rad) {
    std::vector<CameraState> states = AssumeAttitudes(*motions, off_nadir_rad);
    if (states.empty()) return {};
    const CameraTrajectory assumed(states, kMaxDuration_s);
    VICTORIOUS_ASSIGN_OR_RETURN(report_.sun, EstimateSunDirection({assumed, recognizer, *setup_.extractor,
                                                                   setup_.options.sun_direction, job_.threads, true},
                                                                  *video_.reader, cancel_, warn_));
    VICTORIOUS_ASSIGN_OR_RETURN(video_.reader, VideoReader::Open(job_.video, ReaderOptions()));
    if (!report_.sun) continue;
    video_.cameras.SetAssumedAttitudes(std::move(states));
    report_.sun_from_camera = true;
    report_.sun_by_clock = false;
    return {};
  }
  return {};
}

Status IndexRun::EstimateSun(const Recognizer& recognizer) {
  const CameraTrajectory* trajectory = video_.cameras.trajectory();
  report_.sun.reset();
  report_.sun_from_camera = false;
  video_.cameras.SetAssumedAttitudes({});
  report_.sun_by_clock =
      trajectory != nullptr &&
      std::ranges::any_of(trajectory->states(), [](const CameraState& state) { return state.utc_us.has_value(); });
  if (recognizer.models().empty()) return {};
  if (!HasAttitudes(trajectory)) {
    VICTORIOUS_RETURN_IF_ERROR(AssumeSun(recognizer));
    if (report_.sun || trajectory == nullptr) return {};
  }
  const SearchScale scale({.models = recognizer.models(),
                           .cameras = video_.cameras,
                           .ground = setup_.options.objects.ground.get(),
                           .object_px = setup_.options.resolution.object_px,
                           .restart_interval_frames = video_.follow.restart_interval_frames},
                          video_.reader->info());
  VICTORIOUS_ASSIGN_OR_RETURN(
      report_.sun,
      EstimateSunDirection(
          {.cameras = *trajectory,
           .recognizer = recognizer,
           .extractor = *setup_.extractor,
           .options = setup_.options.sun_direction,
           .threads = job_.threads,
           .searched_image = [&](const Frame& frame) { return scale.ShrinkNear(frame.time_s, frame.image); }},
          *video_.reader, cancel_, warn_));
  if (video_.reader->info().live) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(video_.reader, VideoReader::Open(job_.video, ReaderOptions()));
  return {};
}

Status IndexRun::Reopen() {
  if (video_.reader) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(video_.reader, VideoReader::Open(job_.video, ReaderOptions()));
  return {};
}

VideoReaderOptions IndexRun::ReaderOptions() const {
  const bool needs_color = setup_.categories && setup_.categories->IsDetector();
  return {.color = needs_color ? FrameColor::kGreyAndBgr : FrameColor::kGrey,
          .data_packets = true,  // a live source sends them once
          .threads = job_.threads,
          .folder_frame_rate = setup_.options.video.folder_frame_rate};
}

Status IndexRun::SearchPass(const PlannedPass& plan) {
  VICTORIOUS_RETURN_IF_ERROR(Reopen());
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer, MakeRecognizer(plan));
  VICTORIOUS_RETURN_IF_ERROR(EstimateSun(recognizer));
  const std::vector<std::optional<std::int64_t>> category_ids = CategoryIds(plan);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<const ShapeSearch> shapes,
                              MakeShapeSearch(recognizer, video_.cameras, video_.reader->info()));
  IndexPass pass = MakePass(plan, recognizer, category_ids, video_);
  pass.sun = report_.sun;
  pass.shapes = shapes.get();
  pass.duration_s = video_.reader->info().duration_s;
  VICTORIOUS_RETURN_IF_ERROR(RunIndexPass(pass, *video_.reader, cancel_, store_, warn_, report_));
  video_.reader.reset();
  return {};
}

}  // namespace victorious
