#include "victorious/search/follow/follower.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <oneapi/tbb/parallel_for_each.h>
#include <oneapi/tbb/task_arena.h>

#include "victorious/geometry/angles.h"
#include "victorious/search/follow/full_search_schedule.h"
#include "victorious/search/follow/region_features.h"

namespace victorious {

void FollowOptions::ListFields(FieldList& fields) {
  fields.Add("enabled", enabled,
             {.reason = "detected objects are tracked and searched for in their regions; otherwise every full frame is "
                        "searched independently"});
  fields.Add(
      "frame_interval_s", frame_interval_s,
      {.min = 0,
       .max = 1000,
       .unit = "s",
       .reason = "time between frames that are tracked, of videos, rounded to frames: of 30 frames a second each "
                 "third; in those between, boxes are interpolated, but for the last of a video; 0 tracks all"});
  fields.Add("restart_interval_frames", restart_interval_frames,
             {.min = 1,
              .max = kNoRestart,
              .unit = "frames",
              .reason = "all tracks restart after this many tracked frames: the maximum number that are tracked again "
                        "when an index resumes"});
  fields.Add("search_interval_s", search_interval_s,
             {.min = 0,
              .max = 1000,
              .unit = "s",
              .reason = "minimum time between searches of a visible track's region; between them the track follows its "
                        "points: 0 confirms it in every frame, more saves time"});
  fields.AddGroup("track", track);
}

namespace {

// Intersection over union at which a detection is assigned to a track. Boxes of one object in neighbouring frames
// overlap far more, those of two objects hardly do.
constexpr double kMinTrackOverlap = 0.3;
// Presentation times are rounded to milliseconds in some containers.
constexpr double kTimeRounding_s = 0.002;

Box StepBox(const TrackStep& step) { return step.seen() ? step.box : BoundingBox(step.outline); }

bool IsInFrame(const Box& box, const cv::Size& frame) {
  return box.x >= 0 && box.y >= 0 && box.x + box.width <= frame.width && box.y + box.height <= frame.height;
}

FeatureSet WithoutDescriptors(const FeatureSet& features) {
  return {.keypoints = features.keypoints,
          .descriptors = {},
          .image_width = features.image_width,
          .image_height = features.image_height,
          .part = features.part};
}

}  // namespace

Expected<Follower> Follower::Create(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                    const FollowOptions& options, FrameOrder order) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(RegionTracker tracker, RegionTracker::Create(options.track));
  return Follower(recognizer, extractor, options, order, std::move(tracker));
}

bool Follower::IsFollowed(std::int64_t track) const {
  return std::ranges::any_of(tracks_, [&](const auto& entry) { return entry.second.number == track; });
}

void Follower::Stop(std::int64_t track) {
  const auto is_it = [&](const auto& entry) { return entry.second.number == track; };
  const auto found = std::ranges::find_if(tracks_, is_it);
  if (found == tracks_.end()) return;
  tracker_.Stop(found->first);
  tracks_.erase(found);
}

std::vector<TrackStep> Follower::Step(const Frame& frame) {
  if (order_ == FrameOrder::kForward && frame.index % options_.restart_interval_frames == 0) {
    for (const auto& [id, followed] : tracks_) tracker_.Stop(id);
    tracks_.clear();
  }
  constexpr std::int64_t kMaxTracks = 1'000;  // upper bound of those that start in one frame
  last_number_ = frame.index * kMaxTracks;
  std::vector<TrackStep> active;
  for (TrackStep& step : tracker_.Step(frame)) {
    if (step.state == TrackState::kActive) {
      active.push_back(std::move(step));
    } else {
      tracks_.erase(step.track);
    }
  }
  return active;
}

void Follower::Confirm(std::uint64_t track, const Detection& detection, const FeatureSet& features, double time_s) {
  tracker_.Confirm(track, detection.outline, MatchedPoints(detection, features));
  TrackRecord& followed = tracks_.at(track);
  followed.last = detection;
  followed.recognised += 1;
  followed.searched_time_s = time_s;
}

// The region of a visible, confirmed track is searched only each `search_interval_s`, but for the rounding of times.
bool Follower::IsSearchDue(const TrackStep& step, const Frame& frame, RegionSearches searches) const {
  const TrackRecord& followed = tracks_.at(step.track);
  const bool is_confirmed = followed.recognised >= options_.min_recognised_frames;
  const bool has_waited = std::abs(frame.time_s - followed.searched_time_s) >
                          SearchSpacing(frame.image.size()) * options_.search_interval_s - kTimeRounding_s;
  if (searches == RegionSearches::kUnconfirmedOnly) return !is_confirmed && has_waited;
  return !step.seen() || !is_confirmed || has_waited;
}

// One-to-one, pairs of the highest overlap first, so that two objects that pass each other keep their tracks.
std::vector<std::optional<std::uint64_t>> Follower::FindTracks(std::span<const Detection> detections,
                                                               std::span<const TrackStep> open) const {
  struct Pair {
    double overlap;
    std::size_t detection;
    std::uint64_t track;
  };
  std::vector<Pair> pairs;
  for (std::size_t d = 0; d < detections.size(); ++d) {
    for (const TrackStep& step : open) {
      if (tracks_.at(step.track).last.model_index != detections[d].model_index) continue;
      const double overlap = IntersectionOverUnion(detections[d].box, StepBox(step));
      if (overlap >= kMinTrackOverlap) pairs.push_back({overlap, d, step.track});
    }
  }
  std::ranges::stable_sort(pairs, std::greater{}, &Pair::overlap);
  std::vector<std::optional<std::uint64_t>> tracks(detections.size());
  for (const Pair& pair : pairs) {
    if (!tracks[pair.detection] && std::ranges::find(tracks, pair.track) == tracks.end())
      tracks[pair.detection] = pair.track;
  }
  return tracks;
}

ObservedObject Follower::AssignToTrack(const Detection& detection, const FeatureSet& features, double time_s,
                                       std::optional<std::uint64_t> track) {
  ObservedObject seen{.detection = detection, .features = WithoutDescriptors(features), .track = {}};
  if (track) {
    Confirm(*track, detection, features, time_s);
    TrackRecord& followed = tracks_.at(*track);
    followed.max_full_frame_score = std::max(followed.max_full_frame_score, detection.score);
    followed.was_found_by_shape = followed.was_found_by_shape || detection.cue == DetectionCue::kShape;
    seen.track = followed.number;
    return seen;
  }
  const TrackStep step = tracker_.Start(detection.outline, MatchedPoints(detection, features));
  if (step.state != TrackState::kActive) return seen;
  tracks_[step.track] = {.last = detection,
                         .max_full_frame_score = detection.score,
                         .was_found_by_shape = detection.cue == DetectionCue::kShape,
                         .number = ++last_number_,
                         .recognised = 1,
                         .searched_time_s = time_s};
  seen.track = last_number_;
  seen.starts_track = true;
  return seen;
}

// Matches the last view and its neighbours.
Status Follower::SearchByKeypoints(const FrameConditions& conditions, Region& region) const {
  if (region.features->keypoints.empty()) return {};
  const Detection& last = tracks_.at(region.step.track).last;
  const ModelView& view = recognizer_.models()[last.model_index].views[last.view];
  std::vector<std::size_t> views(view.neighbours.begin(), view.neighbours.end());
  views.push_back(last.view);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Detection> detections,
                              recognizer_.RecognizeViews(*region.features, last.model_index, views, conditions));
  for (Detection& detection : detections) {
    if (IntersectionOverUnion(detection.box, StepBox(region.step)) < kMinTrackOverlap) continue;
    detection.score = std::min(detection.score, tracks_.at(region.step.track).max_full_frame_score);
    region.found = std::move(detection);
    return {};
  }
  return {};
}

// Where the tracked points, or the motion of the image, put the object. What was found by keypoints stays unless the
// shape says more: few keypoints that agree give a worse pose than the edges.
Status Follower::SearchByShape(const Frame& frame, const FrameConditions& conditions, Region& region) const {
  if (region.found && (!conditions.vertical || !conditions.height_above_ground_m)) return {};
  const TrackRecord& followed = tracks_.at(region.step.track);
  const Detection& last = followed.last;
  const Box before = BoundingBox(last.outline);
  const Box now = BoundingBox(region.step.outline);
  const Eigen::Vector2d shift_px(now.x + now.width / 2 - before.x - before.width / 2,
                                 now.y + now.height / 2 - before.y - before.height / 2);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ShapeMatch> match,
                              shapes_->FindAgain(frame.image, conditions, last, shift_px));
  region.is_missed = !match && IsInFrame(now, frame.image.size());
  if (!match) return {};
  if (region.found && (!match->is_examined || region.found->neg_log10_nfa >= match->neg_log10_nfa)) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(Detection detection, shapes_->MakeDetection(*match, *region.features));
  detection.score = std::min(detection.score, followed.max_full_frame_score);
  region.found = std::move(detection);
  return {};
}

// Extracts features of the region only, in frame coordinates.
void Follower::Search(const Frame& frame, const FrameConditions& conditions, Region& region) const {
  region.features = FeaturesIn(frame.image, region.step.search_box, extractor_);
  if (!region.features) return;
  Status searched = SearchByKeypoints(conditions, region);
  if (searched && shapes_ != nullptr && tracks_.at(region.step.track).was_found_by_shape) {
    searched = SearchByShape(frame, conditions, region);
  }
  if (!searched) region.features = std::unexpected(std::move(searched).error());
}

bool AreOneObject(const ObservedObject& a, const ObservedObject& b) {
  return a.detection.model_index == b.detection.model_index &&
         IntersectionOverUnion(a.detection.box, b.detection.box) >= kMinTrackOverlap;
}

ObservedObject Follower::MakeTrackedObject(const TrackStep& step, const Frame& frame) const {
  ObservedObject seen{
      .detection = tracks_.at(step.track).last, .features = {}, .followed_frames = step.unconfirmed_frames};
  Detection& detection = seen.detection;
  detection.outline = step.outline;
  detection.box = step.box;
  detection.score *= step.support;
  const PlanarFit& last = tracks_.at(step.track).last.fit;
  const Similarity2& moved = step.now_from_template;
  detection.fit.scene_from_template = {moved.scale * last.scene_from_template.scale,
                                       WrapAngle(moved.rotation_rad + last.scene_from_template.rotation_rad),
                                       moved.Apply(last.scene_from_template.translation)};
  detection.fit.scene_from_template_plane = moved.Matrix() * last.scene_from_template_plane;
  detection.fit.inliers.clear();
  seen.features.image_width = frame.image.cols;
  seen.features.image_height = frame.image.rows;
  for (const TrackPoint& point : step.points) {
    detection.fit.inliers.push_back(last.inliers[point.inlier.value()]);
    detection.fit.inliers.back().scene_keypoint = static_cast<std::uint32_t>(seen.features.size());
    seen.features.keypoints.push_back(
        {.x = static_cast<float>(point.position_px.x()), .y = static_cast<float>(point.position_px.y())});
  }
  return seen;
}

Expected<std::vector<ObservedObject>> Follower::Follow(const Frame& frame, const std::optional<FullFrameResult>& whole,
                                                       const FrameConditions& conditions, RegionSearches searches) {
  std::vector<TrackStep> open = Step(frame);
  std::vector<ObservedObject> seen;
  if (whole) {
    const std::vector<std::optional<std::uint64_t>> tracks = FindTracks(whole->detections, open);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      seen.push_back(AssignToTrack(whole->detections[i], whole->features, frame.time_s, tracks[i]));
    }
    std::erase_if(open, [&](const TrackStep& step) { return std::ranges::find(tracks, step.track) != tracks.end(); });
  }
  std::vector<Region> regions;
  for (TrackStep& step : open) regions.push_back({.step = std::move(step)});
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
    oneapi::tbb::parallel_for_each(regions, [&](Region& region) {
      if (IsSearchDue(region.step, frame, searches)) Search(frame, conditions, region);
    });
  });
  for (Region& region : regions) {
    if (!region.features) return std::unexpected(std::move(region.features).error());
    const std::uint64_t track = region.step.track;
    if (IsSearchDue(region.step, frame, searches)) tracks_.at(track).searched_time_s = frame.time_s;
    ObservedObject next{};
    if (region.found) {
      next = {.detection = *std::move(region.found), .features = WithoutDescriptors(*region.features)};
    } else if (region.step.seen() && tracks_.at(track).recognised >= options_.min_recognised_frames) {
      next = MakeTrackedObject(region.step, frame);
      next.is_missed = region.is_missed;
    } else {
      continue;
    }
    next.track = tracks_.at(track).number;
    // Two tracks of one object: keep the first.
    if (std::ranges::any_of(seen, [&](const ObservedObject& other) { return AreOneObject(other, next); })) {
      Stop(*next.track);
      continue;
    }
    if (!next.tracked()) Confirm(track, next.detection, next.features, frame.time_s);
    seen.push_back(std::move(next));
  }
  return seen;
}

}  // namespace victorious
