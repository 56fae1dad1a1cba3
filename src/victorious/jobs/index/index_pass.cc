#include "victorious/jobs/index/index_pass.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/count_text.h"
#include "victorious/base/stage_time.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/jobs/index/between_frames.h"
#include "victorious/jobs/index/category_sightings.h"
#include "victorious/jobs/index/frame_selector.h"
#include "victorious/jobs/index/grow_results.h"
#include "victorious/jobs/index/search_pace.h"
#include "victorious/jobs/index/search_part_writer.h"
#include "victorious/jobs/index/shape_decision.h"
#include "victorious/jobs/index/shape_detections.h"
#include "victorious/place/associate/tracklet_linker.h"
#include "victorious/place/observe/bearing_observation.h"
#include "victorious/place/observe/object_pose.h"
#include "victorious/search/follow/backward_follower.h"
#include "victorious/search/follow/category_follower.h"
#include "victorious/search/follow/follower.h"

namespace victorious {
namespace {

std::unexpected<Error> Stopped(const std::string& video, std::int64_t frame) {
  return Fail(ErrorCode::kCancelled, fmt::format("{}: stopped at frame {}; run again to resume", video, frame));
}

SightingRecord ToSighting(const IndexPass& pass, const FrameWork& work, const ObservedObject& seen) {
  const Frame& frame = work.now.frame;
  const Detection& detection = seen.detection;
  const bool by_shape = detection.cue == DetectionCue::kShape;
  const ObjectModel& model = pass.recognizer.models()[detection.model_index];
  SightingRecord sighting{.video = pass.video.id,
                          .model = pass.searches[detection.model_index].model,
                          .frame = frame.index,
                          .time_s = frame.time_s,
                          .box = work.sizes.ToFilmed(detection.box),
                          .outline = work.sizes.ToFilmed(detection.outline),
                          .score = detection.score,
                          .source = seen.tracked() ? SightingSource::kTracked : SightingSource::kRecognised,
                          .is_missed = seen.is_missed,
                          .matches = by_shape ? 0 : static_cast<int>(detection.fit.inliers.size()),
                          .view_index = static_cast<int>(detection.view),
                          .view = model.views[detection.view].angles,
                          .in_plane_rad = detection.fit.scene_from_template.rotation_rad,
                          .track = seen.track};
  const CameraState known = work.camera.value_or(CameraState{});
  auto object_pose =
      EstimateObjectPose(detection, model, seen.features, known, pass.options.observation, UpInCamera(known));
  if (!object_pose) return sighting;
  if (by_shape) SetShapeErrors(*object_pose, pass.options.shape);
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

Expected<FeatureSet> ExtractFeatures(const FeatureExtractor& extractor, const Frame& frame) {
  const StageScope scope(Stage::kFeatures);
  return extractor.Extract(frame.image);
}

// Features, recognition and categories of full frames. Where objects are tracked, or rescored in the image, it is left
// without impulse noise. Parallel.
Status Search(const IndexPass& pass, FrameWork& work) {
  if (work.is_between) return {};
  if (work.classify) {
    VICTORIOUS_ASSIGN_OR_RETURN(work.categories, pass.categories->FindIn(work.now.frame));
    std::erase_if(work.categories, [&](const FoundCategory& one) { return !pass.category_ids[one.category]; });
  }
  work.now.frame.bgr.release();
  if (work.keep) {
    VICTORIOUS_ASSIGN_OR_RETURN(work.kept, ExtractFeatures(pass.kept_extractor, work.now.frame));
  }
  const bool is_followed = IsTrackingEnabled(pass) && !work.motion_only;
  if (pass.recognizer.models().empty() || !(work.whole || is_followed)) return {};
  cv::Mat& image = work.now.frame.image;
  const double impulse_fraction = pass.options.features.impulse_fraction;
  const bool is_shrunk = work.sizes.searched != work.sizes.filmed;
  if (is_shrunk) {
    const StageScope scope(Stage::kFeatures);
    image = ShrinkTo(work.sizes.searched, RemoveImpulses(image, impulse_fraction));
  }
  if (work.whole) {
    VICTORIOUS_ASSIGN_OR_RETURN(work.features, ExtractFeatures(pass.extractor, work.now.frame));
  }
  if (!is_shrunk) {
    const StageScope scope(Stage::kFeatures);
    image = RemoveImpulses(image, impulse_fraction);  // extractors do it, of the frame as filmed
  }
  if (!work.whole) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(work.detections,
                              pass.recognizer.Recognize(work.features, work.now.conditions, image, work.views));
  if (!work.by_shape) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(work.shape_detections, FindByShape(*pass.shapes, image, work.now.conditions,
                                                                 pass.options.recognize.detect, work.features));
  return {};
}

// Links and stores, in the order of frames. Serial.
class ResultWriter {
 public:
  ResultWriter(const IndexPass& pass, const VideoInfo& info, IndexStore& store, IndexReport& report)
      : pass_(pass),
        is_live_(info.live),
        store_(store),
        report_(report),
        linker_(MakeTrackletOptions(pass.options.tracklets, pass.intervals,
                                    IsTrackingEnabled(pass) ? &pass.follow : nullptr, info.frame_rate),
                pass.options.objects),
        parts_(pass.searches, IsTrackingEnabled(pass) || FollowsCategories(pass)
                                  ? 1
                                  : std::max(pass.intervals.models, pass.intervals.categories)),
        next_frame_(pass.searches.front().next_frame),
        committed_frame_(next_frame_),
        last_commit_(Clock::now()) {
    constexpr double kFrames = 2.5;
    const double frames = kFrames * std::max(pass.intervals.models, pass.intervals.categories);
    if (info.frame_rate > 0) max_pause_s_ = std::max(max_pause_s_, frames / info.frame_rate);
  }

  /// Enters also which times of the source are covered. @param utc_of  UTC of a frame by its time, microseconds
  void Cover(std::function<std::int64_t(double)> utc_of) { utc_of_ = std::move(utc_of); }

  // Restores the tracklets that may still grow.
  Status Resume() {
    if (next_frame_ == 0 || pass_.segment) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> stored, store_.SearchParts(pass_.video.id));
    parts_.Resume(stored);
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TrackletRecord> tracklets, store_.Tracklets());
    std::erase_if(tracklets, [&](const TrackletRecord& tracklet) {
      return tracklet.video != pass_.video.id ||
             std::ranges::find(pass_.searches, tracklet.model, &SearchRecord::model) == pass_.searches.end();
    });
    if (tracklets.empty()) return {};
    SightingFilter filter{.include_rejected = true, .video = pass_.video.id};
    filter.from_s =
        std::ranges::max(tracklets, {}, &TrackletRecord::last_time_s).last_time_s - linker_.HistorySeconds();
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SightingRecord> sightings, store_.Sightings(filter));
    linker_.Resume(tracklets, sightings);
    return {};
  }

  Status Add(FrameWork& work) { return pass_.segment ? AddToSegment(work) : Link(work); }

  Status Link(FrameWork& work) {
    const StageScope scope(Stage::kStore);
    linker_.Step(work.now.frame.index, work.now_from_before);
    if (work.already_stored) return {};
    report_.frames_searched += work.whole || work.classify ? 1 : 0;
    report_.frames_left_out += work.left_out ? 1 : 0;
    report_.sightings += static_cast<std::int64_t>(work.sightings.size());
    linker_.Link(std::move(work.sightings), batch_);
    if (work.keep) {
      InformOfSize(work.kept);
      batch_.kept_frames.push_back({.video = pass_.video.id,
                                    .frame = work.now.frame.index,
                                    .time_s = work.now.frame.time_s,
                                    .features = std::move(work.kept)});
    }
    next_frame_ = work.now.frame.index + 1;
    parts_.Enter(work.now.frame.index, work.now.frame.time_s, work.left_out, work.damaged);
    EnterCovered(work.now.frame);
    constexpr auto kInterval = std::chrono::seconds(2);
    constexpr std::size_t kKeptFrames = 32;
    // Somebody may be watching a live source.
    if (is_live_ && !batch_.sightings.empty()) return Commit(false);
    if (Clock::now() - last_commit_ < kInterval && batch_.kept_frames.size() < kKeptFrames) return {};
    return Commit(false);
  }

  Status Commit(bool finished) {
    if (pass_.segment) return {};
    const StageScope scope(Stage::kStore);
    for (const SearchRecord& search : pass_.searches) {
      SearchRecord record = search;
      record.next_frame = next_frame_;
      record.finished = finished;
      batch_.progress.push_back({.search = std::move(record), .expected_next_frame = committed_frame_});
    }
    if (covered_) PutCovered();
    parts_.MoveTo(batch_);
    const Expected<std::vector<std::int64_t>> ids = store_.Commit(batch_);
    if (!ids) {
      can_commit_ = false;
      return std::unexpected(ids.error());
    }
    if (!finished) linker_.SetCommittedIds(*ids);
    batch_ = {};
    committed_frame_ = next_frame_;
    last_commit_ = Clock::now();
    return {};
  }

  /// Commits the end of the searches, with what growth adds to their finds. @param times_s  of all frames
  Status Finish(std::span<const double> times_s, const CancelToken& cancel) {
    if (!MayGrow(pass_, is_live_) || times_s.empty()) return Commit(true);
    VICTORIOUS_RETURN_IF_ERROR(Commit(false));  // growth begins with what is stored
    VICTORIOUS_RETURN_IF_ERROR(GrowResults(pass_, times_s, next_frame_, cancel, store_, batch_));
    report_.sightings += std::ssize(batch_.sightings);
    return Commit(true);
  }

  /// Enters what lies after the last search, to the last frame that was read.
  void EnterEnd(std::int64_t last_frame, double last_time_s, const std::optional<DamagedTime>& damaged) {
    parts_.ExtendTo(last_frame, last_time_s);
    if (damaged) parts_.EnterDamage(*damaged);
  }

  /// False after a failed commit.
  [[nodiscard]] bool can_commit() const { return can_commit_; }
  [[nodiscard]] std::int64_t next_frame() const { return next_frame_; }
  [[nodiscard]] std::optional<std::int64_t> FirstRequiredFrame() const {
    return pass_.segment ? pass_.segment->first_read : linker_.FirstRequiredFrame();
  }

 private:
  // Frames without an interruption.
  struct CoveredFrames {
    std::int64_t from_frame = 0;
    double from_s = 0;
    double to_s = 0;
  };

  void EnterCovered(const Frame& frame) {
    if (!utc_of_) return;
    if (covered_ && frame.time_s - covered_->to_s > max_pause_s_) {
      PutCovered();
      covered_.reset();
    }
    if (!covered_) covered_ = {frame.index, frame.time_s, frame.time_s};
    covered_->to_s = frame.time_s;
  }

  // The later, the better is it known when its first frame came.
  void PutCovered() {
    batch_.covered.push_back({.video = pass_.video.id,
                              .from_frame = covered_->from_frame,
                              .source = pass_.source,
                              .from_utc_us = utc_of_(covered_->from_s),
                              .to_utc_us = utc_of_(covered_->to_s)});
  }

  // Another process links the segments.
  Status AddToSegment(FrameWork& work) {
    if (work.already_stored) return {};
    report_.frames_searched += work.whole || work.classify ? 1 : 0;
    report_.sightings += static_cast<std::int64_t>(work.sightings.size());
    std::optional<KeptFrame> kept;
    if (work.keep) {
      kept = {.video = pass_.video.id,
              .frame = work.now.frame.index,
              .time_s = work.now.frame.time_s,
              .features = std::move(work.kept)};
    }
    next_frame_ = work.now.frame.index + 1;
    pass_.segment->add({.frame = work.now.frame.index,
                        .is_whole = work.whole || work.classify,
                        .now_from_before = work.now_from_before,
                        .sightings = std::move(work.sightings)},
                       std::move(kept));
    return {};
  }

  // Tells the expected size of the features, once, if it matters.
  void InformOfSize(const FeatureSet& kept) {
    constexpr double kBytesPerFeature = 80;  // docs/formats/index.md
    constexpr double kMinReportedBytes = 100e6;
    constexpr double kShortest_s = 0.01;
    const double interval_s = pass_.options.keep.interval_s;
    if (informed_ || !pass_.job.inform || !pass_.duration_s || kept.size() == 0 || interval_s <= kShortest_s) return;
    informed_ = true;
    const double until_s = std::min(*pass_.duration_s, pass_.job.to_s.value_or(*pass_.duration_s));
    const double frames = (until_s - pass_.job.from_s.value_or(0)) / interval_s;
    const double bytes = frames * static_cast<double>(kept.size()) * kBytesPerFeature;
    if (bytes < kMinReportedBytes) return;
    pass_.job.inform(
        fmt::format("the features kept for `search --image` will take about {:.1f} GB ({} of a frame, one frame "
                    "each {:g} s); --keep-features sets the interval, or none",
                    bytes / 1e9, CountText(kept.size(), "feature"), interval_s));
  }

  using Clock = std::chrono::steady_clock;

  const IndexPass& pass_;
  bool is_live_;
  IndexStore& store_;
  IndexReport& report_;
  TrackletLinker linker_;
  SearchPartWriter parts_;
  IndexBatch batch_;
  std::int64_t next_frame_;
  std::int64_t committed_frame_;
  Clock::time_point last_commit_;
  std::function<std::int64_t(double)> utc_of_;  // set if the times of the source are entered
  std::optional<CoveredFrames> covered_;
  double max_pause_s_ = 1;  // between the frames of one interval
  bool informed_ = false;
  bool can_commit_ = true;
};

// Tracks the objects of frames, forward and backward, and passes the frames on to the writer. Serial, in the order of
// frames. Frames are held until later ones can no longer add to them: with a live source, whose finds somebody may be
// watching for, not at all.
class TrackingStage {
 public:
  [[nodiscard]] static Expected<TrackingStage> Create(const IndexPass& pass, bool is_live, ResultWriter& writer) {
    TrackingStage stage(pass, is_live, writer);
    if (IsTrackingEnabled(pass)) {
      VICTORIOUS_ASSIGN_OR_RETURN(Follower follower, Follower::Create(pass.recognizer, pass.extractor, pass.follow));
      if (pass.shapes != nullptr) follower.SearchByShape(*pass.shapes);
      stage.follower_.emplace(std::move(follower));
    }
    return stage;
  }

  Status Add(FrameWork& task) {
    const FollowedFrame& now = task.now;
    if (task.is_between) {
      between_.push_back(std::move(task));
      return {};
    }
    if (now.frame.index % pass_.follow.restart_interval_frames == 0) VICTORIOUS_RETURN_IF_ERROR(FlushHeld());
    {
      const StageScope scope(Stage::kTracking);
      if (!task.motion_only) VICTORIOUS_RETURN_IF_ERROR(Track(task));
      if (!task.motion_only && FollowsCategories(pass_)) FollowCategoriesOf(task);
      if (task.undecided.empty()) {
        task.features = {};
      } else {  // the next search by shape follows them, by their keypoints; held frames keep no descriptors
        task.features.descriptors = std::vector<std::uint8_t>();
      }
    }
    const std::size_t image_bytes = now.frame.image.total() * now.frame.image.elemSize();
    const std::size_t max_held = follower_ && !is_live_ ? HeldFrameCount(pass_.follow, image_bytes) : 0;
    held_.push_back({.between = std::exchange(between_, {}), .tracked = std::move(task)});
    while (held_.size() > max_held) VICTORIOUS_RETURN_IF_ERROR(PassOn());
    return {};
  }

  // Passes on what is held, at the end of the video.
  Status Finish() {
    VICTORIOUS_RETURN_IF_ERROR(FlushHeld());
    for (FrameWork& last : between_) VICTORIOUS_RETURN_IF_ERROR(writer_.Add(last));
    between_.clear();
    return {};
  }

 private:
  struct HeldFrame {
    std::vector<FrameWork> between;  // the frames before it that are not tracked
    FrameWork tracked;
  };

  TrackingStage(const IndexPass& pass, bool is_live, ResultWriter& writer)
      : pass_(pass), is_live_(is_live), writer_(writer) {}

  Status FlushHeld() {
    while (!held_.empty()) VICTORIOUS_RETURN_IF_ERROR(PassOn());
    return {};
  }

  // Sets the objects of a frame, and adds to those of the held frames.
  Status Track(FrameWork& task) {
    std::vector<const FrameWork*> held_before;
    for (const HeldFrame& held : held_) held_before.push_back(&held.tracked);
    VICTORIOUS_RETURN_IF_ERROR(AddShapeDetections(pass_, held_before, task));
    FollowedFrame& now = task.now;
    if (!follower_) {
      for (const Detection& detection : task.detections) {
        now.objects.push_back({.detection = detection, .features = task.features, .track = {}});
      }
      return {};
    }
    const auto whole = task.whole ? std::optional<FullFrameResult>({task.features, task.detections}) : std::nullopt;
    const auto searches = task.has_time ? RegionSearches::kAllDue : RegionSearches::kUnconfirmedOnly;
    VICTORIOUS_ASSIGN_OR_RETURN(now.objects, follower_->Follow(now.frame, whole, now.conditions, searches));
    std::vector<FollowedFrame*> before;
    for (HeldFrame& held : held_ | std::views::reverse) before.push_back(&held.tracked.now);
    return FollowBackward(pass_.recognizer, pass_.extractor, pass_.follow, now, task.features, before, pass_.shapes);
  }

  void FollowCategoriesOf(FrameWork& task) {
    const cv::Mat& image = task.now.frame.image;
    if (task.classify) return category_follower_.Restart(image, task.categories);
    task.categories = category_follower_.Follow(image, task.now_from_before);
  }

  // Makes the sightings of the oldest held frame, and those of the frames before it that are not tracked.
  Status PassOn() {
    auto [between, oldest] = std::move(held_.front());
    held_.pop_front();
    {
      const StageScope scope(Stage::kTracking);
      for (const ObservedObject& one : oldest.now.objects) {
        oldest.sightings.push_back(ToSighting(pass_, oldest, one));
      }
      for (const FoundCategory& found : oldest.categories) {
        oldest.sightings.push_back(CategorySighting(pass_, oldest.now.frame, oldest.camera, found));
      }
    }
    if (pass_.intervals.tracked > 1) {
      VICTORIOUS_RETURN_IF_ERROR(PassOnBetween(between, oldest));
      last_sightings_ = oldest.sightings;
      last_time_s_ = oldest.now.frame.time_s;
    }
    return writer_.Add(oldest);
  }

  // The image has moved evenly since the last tracked frame.
  Status PassOnBetween(std::span<FrameWork> between, FrameWork& next) {
    const std::optional<Similarity2> motion = next.now_from_before;
    const double interval_s = std::max(1e-9, next.now.frame.time_s - last_time_s_);
    Similarity2 moved;
    const auto enter_motion = [&](FrameWork& frame, double part) {
      if (!motion || between.empty()) return;
      const Similarity2 until_now = PartOfMotion(*motion, part);
      frame.now_from_before = until_now * moved.Inverse();
      moved = until_now;
    };
    for (FrameWork& frame : between) {
      const double time_s = frame.now.frame.time_s;
      enter_motion(frame, std::clamp((time_s - last_time_s_) / interval_s, 0.0, 1.0));
      frame.sightings = SightingsBetween(last_sightings_, next.sightings, frame.now.frame.index, time_s);
      VICTORIOUS_RETURN_IF_ERROR(writer_.Add(frame));
    }
    enter_motion(next, 1);
    return {};
  }

  const IndexPass& pass_;
  bool is_live_;
  ResultWriter& writer_;
  std::optional<Follower> follower_;
  CategoryFollower category_follower_;
  std::deque<HeldFrame> held_;                  // oldest first
  std::vector<FrameWork> between_;              // since the last tracked frame
  std::vector<SightingRecord> last_sightings_;  // of the last tracked frame that was passed on
  double last_time_s_ = 0;
};

}  // namespace

Status RunIndexPass(const IndexPass& pass, VideoReader& reader, const CancelToken& cancel, IndexStore& store,
                    const WarningSink& warn, IndexReport& report) {
  ResultWriter sink(pass, reader.info(), store, report);
  VICTORIOUS_RETURN_IF_ERROR(sink.Resume());
  if (pass.job.frame_budget && reader.info().live && pass.job.inform) {
    pass.job.inform("a live source keeps its pace by itself: its budget is not used");
  }
  SearchPace pace(pass.job.frame_budget, reader.info().live);
  TellOfDetector(pass, reader.info());
  FrameSelector selector(pass, reader.info(), pace, sink.FirstRequiredFrame());
  VICTORIOUS_ASSIGN_OR_RETURN(TrackingStage tracking, TrackingStage::Create(pass, reader.info().live, sink));
  FrameLoop loop(reader, cancel,
                 {.label = pass.video.name,
                  .threads = pass.job.threads,
                  .packets = pass.cameras.packet_receiver(),
                  .frame_count = pass.job.to_s ? CountFramesUntil(reader.info(), *pass.job.to_s) : std::nullopt});
  if (!pass.source.empty()) {
    sink.Cover([&](double time_s) {
      return reader.ArrivalUtc(time_s).value_or(pass.recorded_utc_us.value_or(0) + std::llround(1e6 * time_s));
    });
  }
  DamageFinder damage(reader);
  std::vector<double> times_s;
  const Expected<FrameLoopEnd> end = loop.Run<FrameWork>(
      [&](Frame frame) -> std::optional<FrameWork> {
        if (IsBeyondEnd(pass, frame)) {
          loop.Stop();
          return std::nullopt;
        }
        damage.Enter(frame);
        if (frame.index == std::ssize(times_s)) times_s.push_back(frame.time_s);
        auto task = selector.Select(std::move(frame), loop.ReadBehind());
        if (task) task->damaged = damage.Take();
        return task;
      },
      {Parallel<FrameWork>([&](FrameWork& task) {
         Status searched = Search(pass, task);
         if (task.is_slow) pace.EndFullSearch();
         return searched;
       }),
       InOrder<FrameWork>([&](FrameWork& task) { return tracking.Add(task); })});
  if (warn) {
    if (const auto mean = pace.MissedBudget()) warn(MissedBudgetText(*pass.job.frame_budget, *mean));
    std::ranges::for_each(reader.warnings(), warn);
    for (const std::string& warning : pass.cameras.LiveWarnings()) warn("telemetry: " + warning);
  }
  // Commits what was searched before an error or a cancellation.
  if (!end) {
    if (sink.can_commit()) VICTORIOUS_RETURN_IF_ERROR(sink.Commit(false));
    return std::unexpected(end.error());
  }
  const bool cancelled = *end == FrameLoopEnd::kCancelled;
  // What is held of a cancelled video is searched again: frames that would have come might add to it.
  if (!cancelled) VICTORIOUS_RETURN_IF_ERROR(tracking.Finish());
  const auto damaged = *end == FrameLoopEnd::kEndOfVideo ? damage.Finish() : std::nullopt;
  if (!cancelled) sink.EnterEnd(damage.last_frame(), damage.last_time_s(), damaged);
  report.stopped_live = cancelled && reader.info().live;  // cannot be resumed
  VICTORIOUS_RETURN_IF_ERROR(cancelled ? sink.Commit(report.stopped_live) : sink.Finish(times_s, cancel));
  if (cancelled && !report.stopped_live) return Stopped(pass.video.name, sink.next_frame());
  if (*end == FrameLoopEnd::kStopped || pass.segment) return {};  // the video goes on
  return store.SetVideoLength(pass.video.id, loop.frames_read(), loop.last_time_s());
}

Expected<std::int64_t> FirstLinkedFrame(const IndexPass& pass, const VideoInfo& info, IndexStore& store) {
  IndexReport unused;
  ResultWriter sink(pass, info, store, unused);
  VICTORIOUS_RETURN_IF_ERROR(sink.Resume());
  return std::min(sink.next_frame(), sink.FirstRequiredFrame().value_or(sink.next_frame()));
}

Status JoinFrames(const IndexPass& pass, const VideoInfo& info,
                  const std::function<Status(const std::function<Status(std::vector<FrameResult>)>& add)>& visit,
                  bool is_end, const CancelToken& cancel, IndexStore& store, IndexReport& report) {
  ResultWriter sink(pass, info, store, report);
  VICTORIOUS_RETURN_IF_ERROR(sink.Resume());
  const std::int64_t next_frame = sink.next_frame();
  const Status joined = visit([&](std::vector<FrameResult> results) -> Status {
    for (FrameResult& result : results) {
      if (cancel.IsCancelled()) return Stopped(pass.video.name, sink.next_frame());
      FrameWork task;
      task.now.frame.index = result.frame;
      task.now.frame.time_s = pass.times_s[static_cast<std::size_t>(result.frame)];
      task.whole = result.is_whole;
      task.already_stored = result.frame < next_frame;
      task.now_from_before = result.now_from_before;
      task.sightings = std::move(result.sightings);
      VICTORIOUS_RETURN_IF_ERROR(sink.Add(task));
    }
    return {};
  });
  if (joined && is_end) sink.EnterEnd(std::ssize(pass.times_s) - 1, pass.times_s.back(), {});
  if (joined) return is_end ? sink.Finish(pass.times_s, cancel) : sink.Commit(false);
  if (sink.can_commit()) VICTORIOUS_RETURN_IF_ERROR(sink.Commit(false));
  return joined;
}

}  // namespace victorious
