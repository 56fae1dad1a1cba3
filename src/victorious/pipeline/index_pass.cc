#include "victorious/pipeline/index_pass.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include "victorious/associate/tracklet_linker.h"
#include "victorious/base/progress.h"
#include "victorious/calibrate/sun_survey.h"
#include "victorious/geometry/angles.h"
#include "victorious/observe/bearing_observation.h"
#include "victorious/observe/object_pose.h"
#include "victorious/pipeline/follower.h"
#include "victorious/pipeline/live_cameras.h"
#include "victorious/track/camera_motion.h"

namespace victorious {
namespace {

// A frame in the pipeline: read, searched, tracked, collected.
struct FrameTask {
  Frame frame;
  bool whole = true;                           // full-frame search
  bool keep = false;                           // keep its features
  bool already_stored = false;                 // results are stored already: only updates the trackers
  bool motion_only = false;                    // before the restart of tracking: only camera motion is needed
  std::optional<Similarity2> now_from_before;  // camera motion from the previous frame
  std::optional<CameraState> camera;
  Expected<FeatureSet> features = FeatureSet{};
  std::vector<Detection> detections;
  std::vector<FoundCategory> categories;
  std::vector<SightingRecord> sightings;
};
using FrameTaskPtr = std::shared_ptr<FrameTask>;

// Selects one frame per interval, counted from the beginning of the video: the same frames after any interruption.
class KeptFrameSelector {
 public:
  explicit KeptFrameSelector(double interval_s) : interval_s_(interval_s) {}

  bool IsSelected(double time_s) {
    if (interval_s_ <= 0) return true;
    const double slot = std::floor(time_s / interval_s_ + 1e-9);
    return std::exchange(last_slot_, slot) != slot;
  }

 private:
  double interval_s_;
  double last_slot_ = -1;
};

// True if objects are tracked between full-frame searches. Categories are searched for in full frames only.
bool IsTrackingEnabled(const IndexPass& pass) {
  return pass.options.follow.enabled && !pass.recognizer.models().empty();
}

// True for a live source with data streams, if no telemetry was given.
bool HasLiveTelemetry(const IndexPass& pass, const VideoInfo& info) {
  const auto is_telemetry = [](const StreamInfo& stream) { return stream.type == "data" || stream.type == "subtitle"; };
  return info.live && pass.cameras == nullptr && std::ranges::any_of(info.streams, is_telemetry);
}

// Reads the frames to search, with their camera states. Serial.
class FrameSource {
 public:
  /// @param first_required_frame  first frame whose camera motion is needed, if before those to search
  FrameSource(const IndexPass& pass, std::optional<std::int64_t> first_required_frame, VideoReader& reader,
              const CancelToken& cancel, Progress& progress)
      : reader_(reader),
        cancel_(cancel),
        progress_(progress),
        selector_(pass.options.keep.interval_s),
        pass_(pass),
        next_frame_(pass.searches.front().next_frame) {
    if (HasLiveTelemetry(pass, reader.info())) live_.emplace(pass.options.telemetry);
    follow_from_ = next_frame_;
    if (IsTrackingEnabled(pass)) follow_from_ -= next_frame_ % pass.options.follow.restart_interval_frames;
    first_frame_ = std::min(follow_from_, first_required_frame.value_or(follow_from_));
  }

  // The next frame to search or track; null at the end, when cancelled, or on an error.
  FrameTaskPtr Next() {
    while (std::optional<Frame> frame = NextFrame()) {
      const std::int64_t index = frame->index;
      const bool whole = IsWhole(index);
      const bool keep = whole && selector_.IsSelected(frame->time_s);
      if (index < first_frame_) {
        progress_.Update(index + 1);  // before any frame enters the pipeline: nothing else reports progress yet
        continue;
      }
      if (!whole && !IsTrackingEnabled(pass_)) continue;
      auto work = std::make_shared<FrameTask>();
      work->camera = CameraAt(frame->time_s);
      work->frame = *std::move(frame);
      work->already_stored = index < next_frame_;
      work->motion_only = index < follow_from_;
      work->whole = whole && !work->motion_only;
      work->keep = keep;
      return work;
    }
    return nullptr;
  }

  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] bool at_end() const { return at_end_; }
  [[nodiscard]] std::int64_t frames_read() const { return frames_read_; }
  [[nodiscard]] double last_time_s() const { return last_time_s_; }

  // Warnings of a live source's telemetry.
  [[nodiscard]] std::vector<std::string> TelemetryWarnings() const {
    return live_ ? live_->Warnings() : std::vector<std::string>();
  }

 private:
  // Tracks restart with a full-frame search.
  [[nodiscard]] bool IsWhole(std::int64_t index) const {
    const FollowOptions& follow = pass_.options.follow;
    return index % pass_.options.every == 0 || (follow.enabled && index % follow.restart_interval_frames == 0);
  }

  // Holds back a live source's frames until their telemetry has arrived, for at most `live_wait_s`.
  std::optional<Frame> NextFrame() {
    if (!live_) return ReadFrame();
    const double max_wait_s = pass_.options.live_wait_s;
    const auto has_waited = [&] {
      const double first_s = waiting_.front().time_s;
      return live_->Covers(first_s) || waiting_.back().time_s >= first_s + max_wait_s;
    };
    while (waiting_.empty() || !has_waited()) {
      std::optional<Frame> frame = ReadFrame();
      if (!frame) break;
      waiting_.push_back(*std::move(frame));
    }
    if (waiting_.empty()) return std::nullopt;
    Frame first = std::move(waiting_.front());
    waiting_.pop_front();
    return first;
  }

  std::optional<Frame> ReadFrame() {
    if (!status_ || at_end_ || cancel_.IsCancelled()) return std::nullopt;
    Expected<std::optional<Frame>> frame = reader_.NextFrame();
    if (!frame) {
      status_ = std::unexpected(std::move(frame).error());
      return std::nullopt;
    }
    if (!*frame) {
      at_end_ = true;
      return std::nullopt;
    }
    ++frames_read_;
    last_time_s_ = (*frame)->time_s;
    std::vector<DataPacket> packets = reader_.TakeDataPackets();
    if (live_) status_ = live_->Add(std::move(packets), last_time_s_);
    return *std::move(frame);
  }

  // Camera state from telemetry, with the parameters' field of view as fallback.
  [[nodiscard]] std::optional<CameraState> CameraAt(double time_s) const {
    std::optional<CameraState> camera;
    if (pass_.cameras != nullptr) camera = pass_.cameras->At(time_s);
    if (live_) camera = live_->At(time_s);
    const double hfov_deg = pass_.options.telemetry.hfov_deg;
    if (hfov_deg > 0) {
      if (!camera) camera.emplace(CameraState{.time_s = time_s});
      if (!camera->hfov_rad) camera->hfov_rad = RadiansFromDegrees(hfov_deg);
    }
    return camera;
  }

  VideoReader& reader_;
  const CancelToken& cancel_;
  Progress& progress_;
  KeptFrameSelector selector_;
  const IndexPass& pass_;
  std::int64_t next_frame_;
  std::int64_t follow_from_;
  std::int64_t first_frame_;
  Status status_;
  bool at_end_ = false;
  std::int64_t frames_read_ = 0;
  double last_time_s_ = 0;
  std::optional<LiveCameraTrack> live_;
  std::deque<Frame> waiting_;  // frames of a live source that wait for telemetry
};

SightingRecord ToSighting(const IndexPass& pass, const Frame& frame, const FeatureSet& features,
                          const std::optional<CameraState>& camera, const ObservedObject& seen) {
  const Detection& detection = seen.detection;
  const ObjectModel& model = pass.recognizer.models()[detection.model_index];
  SightingRecord sighting{.video = pass.video.id,
                          .model = pass.searches[detection.model_index].model,
                          .frame = frame.index,
                          .time_s = frame.time_s,
                          .box = detection.box,
                          .outline = detection.outline,
                          .score = detection.score,
                          .source = seen.tracked() ? "tracked" : "recognised",
                          .matches = static_cast<int>(detection.fit.inliers.size()),
                          .view_index = static_cast<int>(detection.view),
                          .view = model.views[detection.view].angles,
                          .in_plane_rad = detection.fit.scene_from_template.rotation_rad,
                          .track = seen.track};
  const CameraState known = camera.value_or(CameraState{});
  auto object_pose = EstimateObjectPose(detection, model, features, known, pass.options.observation, UpInCamera(known));
  if (!object_pose) return sighting;
  AddTrackingDrift(*object_pose, seen.followed_frames, pass.options.observation);
  if (object_pose->view) {
    sighting.view = object_pose->view->angles;
    sighting.in_plane_rad = object_pose->view->in_plane_rad;
    sighting.sigma_view_rad = object_pose->view->sigma_rad;
  }
  sighting.distance_m = object_pose->range_m;
  if (object_pose->range_m) sighting.sigma_distance_m = object_pose->sigma_range_m;
  sighting.observation = MakeBearingObservation(*object_pose, known);
  return sighting;
}

SightingRecord ToSighting(const IndexPass& pass, const FrameTask& work, const FoundCategory& found) {
  const CameraState known = work.camera.value_or(CameraState{});
  const auto object_pose = EstimateBoxDirection(found.box, work.frame.image.size(), known, kCategoryCentreFraction);
  return {.video = pass.video.id,
          .model = *pass.category_ids[found.category],
          .frame = work.frame.index,
          .time_s = work.frame.time_s,
          .box = found.box,
          .score = found.probability,
          .observation = object_pose ? MakeBearingObservation(*object_pose, known) : std::nullopt};
}

// Features, recognition and categories of full frames. Parallel.
void Search(const IndexPass& pass, FrameTask& work) {
  if (!work.whole) return;
  if (pass.categories != nullptr && !work.already_stored) {
    Expected<std::vector<FoundCategory>> found = pass.categories->Find(work.frame.image);
    if (!found) {
      work.features = std::unexpected(std::move(found).error());
      return;
    }
    work.categories = *std::move(found);
    std::erase_if(work.categories, [&](const FoundCategory& one) { return !pass.category_ids[one.category]; });
  }
  if (pass.recognizer.models().empty() && !work.keep) return;
  work.features = pass.extractor.Extract(work.frame.image);
  if (work.features) {
    Expected<std::vector<Detection>> detections = pass.recognizer.Recognize(
        *work.features, MakeFrameConditions(work.camera, work.frame.image.size(), pass.sun), work.frame.image);
    if (detections) {
      work.detections = *std::move(detections);
    } else {
      work.features = std::unexpected(std::move(detections).error());
    }
  }
}

// Makes sightings of detections, through the follower if there is one. Serial, in the order of frames.
void Follow(const IndexPass& pass, std::optional<Follower>& follower, ImageMotionEstimator& motion, FrameTask& work) {
  work.now_from_before = motion.Step(work.frame.image);
  if (!work.features || work.motion_only) return;
  if (!follower) {
    for (const Detection& detection : work.detections) {
      work.sightings.push_back(ToSighting(pass, work.frame, *work.features, work.camera, {.detection = detection}));
    }
  } else {
    std::optional<FullFrameResult> whole;
    if (work.whole) whole.emplace(*work.features, work.detections);
    Expected<std::vector<ObservedObject>> all =
        follower->Follow(work.frame, whole, MakeFrameConditions(work.camera, work.frame.image.size(), pass.sun));
    if (!all) {
      work.features = std::unexpected(std::move(all).error());
      return;
    }
    for (const ObservedObject& one : *all)
      work.sightings.push_back(ToSighting(pass, work.frame, one.features, work.camera, one));
  }
  for (const FoundCategory& found : work.categories) work.sightings.push_back(ToSighting(pass, work, found));
  work.frame.image.release();
}

// Raises the gap of a tracklet to 2.5 searched frames, and to the number of frames that a track may miss.
TrackletOptions MakeTrackletOptions(const IndexPass& pass, double frame_rate) {
  constexpr double kFrames = 2.5;
  TrackletOptions tracklets = pass.options.tracklets;
  const double frames = std::max(kFrames * pass.options.every,
                                 IsTrackingEnabled(pass) ? pass.options.follow.track.missed_frames + 1.5 : 0.0);
  if (frame_rate > 0) tracklets.gap_s = std::max(tracklets.gap_s, frames / frame_rate);
  return tracklets;
}

// Links and stores, in the order of frames. Serial.
class ResultWriter {
 public:
  ResultWriter(const IndexPass& pass, double frame_rate, IndexStore& store, IndexReport& report)
      : pass_(pass),
        store_(store),
        report_(report),
        linker_(MakeTrackletOptions(pass, frame_rate), pass.options.objects),
        next_frame_(pass.searches.front().next_frame),
        committed_frame_(next_frame_),
        last_commit_(Clock::now()) {}

  // Restores the tracklets that may still grow.
  Status Resume() {
    if (next_frame_ == 0) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TrackletRecord> runs, store_.Tracklets());
    std::erase_if(runs, [&](const TrackletRecord& run) {
      return run.video != pass_.video.id ||
             std::ranges::find(pass_.searches, run.model, &SearchRecord::model) == pass_.searches.end();
    });
    if (runs.empty()) return {};
    SightingFilter filter{.video_name = pass_.video.name, .include_rejected = true};
    filter.from_s = std::ranges::max(runs, {}, &TrackletRecord::last_time_s).last_time_s - linker_.HistorySeconds();
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SightingRecord> sightings, store_.Sightings(filter));
    linker_.Resume(runs, sightings);
    return {};
  }

  Status Add(FrameTask& work) {
    if (!work.features) return std::unexpected(std::move(work.features).error());
    linker_.Step(work.frame.index, work.now_from_before);
    if (work.already_stored) return {};
    report_.frames_searched += work.whole ? 1 : 0;
    report_.sightings += static_cast<std::int64_t>(work.sightings.size());
    linker_.Link(std::move(work.sightings), batch_);
    if (work.keep) {
      batch_.kept_frames.push_back({.video = pass_.video.id,
                                    .frame = work.frame.index,
                                    .time_s = work.frame.time_s,
                                    .features = *std::move(work.features)});
    }
    next_frame_ = work.frame.index + 1;
    constexpr auto kInterval = std::chrono::seconds(2);
    constexpr std::size_t kKeptFrames = 32;
    if (Clock::now() - last_commit_ < kInterval && batch_.kept_frames.size() < kKeptFrames) return {};
    return Commit(false);
  }

  Status Commit(bool finished) {
    for (const SearchRecord& search : pass_.searches) {
      SearchRecord record = search;
      record.next_frame = next_frame_;
      record.finished = finished;
      batch_.progress.push_back({.search = std::move(record), .expected_next_frame = committed_frame_});
    }
    const Expected<std::vector<std::int64_t>> ids = store_.Commit(batch_);
    if (!ids) {
      can_commit_ = false;
      return std::unexpected(ids.error());
    }
    linker_.SetCommittedIds(*ids);
    batch_ = {};
    committed_frame_ = next_frame_;
    last_commit_ = Clock::now();
    return {};
  }

  /// False after a failed commit.
  [[nodiscard]] bool can_commit() const { return can_commit_; }
  [[nodiscard]] std::int64_t next_frame() const { return next_frame_; }
  [[nodiscard]] std::optional<std::int64_t> FirstRequiredFrame() const { return linker_.FirstRequiredFrame(); }

 private:
  using Clock = std::chrono::steady_clock;

  const IndexPass& pass_;
  IndexStore& store_;
  IndexReport& report_;
  TrackletLinker linker_;
  IndexBatch batch_;
  std::int64_t next_frame_;
  std::int64_t committed_frame_;
  Clock::time_point last_commit_;
  bool can_commit_ = true;
};

}  // namespace

Status RunIndexPass(const IndexPass& pass, VideoReader& reader, const CancelToken& cancel, IndexStore& store,
                    const WarningSink& warn, IndexReport& report) {
  namespace tbb = oneapi::tbb;
  Progress progress(pass.video.name, reader.info().frame_count, "frames");
  ResultWriter sink(pass, reader.info().frame_rate, store, report);
  VICTORIOUS_RETURN_IF_ERROR(sink.Resume());
  FrameSource source(pass, sink.FirstRequiredFrame(), reader, cancel, progress);
  ImageMotionEstimator motion;
  std::optional<Follower> follower;
  if (IsTrackingEnabled(pass)) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Follower made,
        Follower::Create(pass.recognizer, pass.extractor, pass.options.features.impulse_fraction, pass.options.follow));
    follower.emplace(std::move(made));
  }

  const int threads =
      pass.threads > 0 ? pass.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  Status status;  // written by the serial collect stage only
  std::atomic<bool> failed = false;
  // An arena cannot exceed the hardware concurrency without global_control; oneTBB would warn on stderr.
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    const auto read =
        tbb::make_filter<void, FrameTaskPtr>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
          FrameTaskPtr work = failed ? nullptr : source.Next();
          if (!work) control.stop();
          return work;
        });
    const auto search =
        tbb::make_filter<FrameTaskPtr, FrameTaskPtr>(tbb::filter_mode::parallel, [&](FrameTaskPtr work) {
          Search(pass, *work);
          return work;
        });
    const auto follow =
        tbb::make_filter<FrameTaskPtr, FrameTaskPtr>(tbb::filter_mode::serial_in_order, [&](FrameTaskPtr work) {
          Follow(pass, follower, motion, *work);
          return work;
        });
    const auto collect =
        tbb::make_filter<FrameTaskPtr, void>(tbb::filter_mode::serial_in_order, [&](const FrameTaskPtr& work) {
          if (status) status = sink.Add(*work);
          if (!status) failed = true;
          progress.Update(work->frame.index + 1);
        });
    tbb::parallel_pipeline(static_cast<std::size_t>(threads) * 2, read & search & follow & collect);
  });
  if (warn) {
    std::ranges::for_each(reader.warnings(), warn);
    for (const std::string& warning : source.TelemetryWarnings()) warn("telemetry: " + warning);
  }
  // Commits what was searched before an error or a cancellation.
  if (!status) {
    if (sink.can_commit()) VICTORIOUS_RETURN_IF_ERROR(sink.Commit(false));
    return status;
  }
  const bool cancelled = source.status() && !source.at_end();
  report.stopped_live = cancelled && reader.info().live;  // cannot be resumed
  VICTORIOUS_RETURN_IF_ERROR(sink.Commit(source.at_end() || report.stopped_live));
  VICTORIOUS_RETURN_IF_ERROR(source.status());
  if (cancelled && !report.stopped_live) {
    return Fail(ErrorCode::kCancelled,
                fmt::format("{}: stopped at frame {}; run again to resume", pass.video.name, sink.next_frame()));
  }
  return store.SetVideoLength(pass.video.id, source.frames_read(), source.last_time_s());
}

}  // namespace victorious
