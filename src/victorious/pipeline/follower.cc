#include "victorious/pipeline/follower.h"

#include <algorithm>
#include <utility>

#include <oneapi/tbb/parallel_for_each.h>

#include "victorious/image/impulse_noise.h"
#include "victorious/geometry/angles.h"
#include "victorious/pipeline/region_features.h"

namespace victorious {

void FollowOptions::ListFields(FieldList& fields) {
  fields.Add("enabled", enabled,
             {.reason = "detected objects are tracked and searched for in their regions; otherwise every full frame is "
                        "searched independently"});
  fields.Add("least_overlap", least_overlap,
             {.min = 0, .max = 1, .reason = "intersection over union above which a detection is assigned to a track"});
  fields.Add("restart_frames", restart_frames,
             {.min = 1,
              .max = 1e6,
              .unit = "frames",
              .reason = "all tracks restart at this interval: the maximum number of frames that are tracked again when "
                        "an index resumes"});
  fields.Add("least_recognised", least_recognised,
             {.min = 1,
              .max = 1000,
              .unit = "frames",
              .reason = "frames in which a track must have been recognised before a tracked sighting counts: false "
                        "recognitions seldom repeat"});
  fields.Add("search_every", search_every,
             {.min = 1,
              .max = 1000,
              .unit = "frames",
              .reason = "interval between searches of a visible track's region: 1 confirms the track in every frame, "
                        "more saves time"});
  fields.AddGroup("track", track);
}

namespace {

Box BoxOf(const TrackStep& step) { return step.seen() ? step.box : BoundingBox(step.outline); }

Frame CleanGrey(const Frame& frame, double impulse_share) {
  Frame clean = frame;
  if (impulse_share < 1) clean.image = WithoutImpulses(frame.image, impulse_share);
  return clean;
}

// The step with the highest overlap with the detection, or the end.
std::vector<TrackStep>::iterator StepOf(const Box& box, std::vector<TrackStep>& steps, double least_overlap) {
  const auto overlap = [&](const TrackStep& step) { return IntersectionOverUnion(box, BoxOf(step)); };
  const auto best = std::ranges::max_element(steps, {}, overlap);
  return best != steps.end() && overlap(*best) >= least_overlap ? best : steps.end();
}

}  // namespace

Expected<Follower> Follower::Create(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                    double impulse_share, const FollowOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(RegionTracker tracker, RegionTracker::Create(options.track));
  return Follower(recognizer, extractor, impulse_share, options, std::move(tracker));
}

std::vector<TrackStep> Follower::Step(const Frame& frame) {
  if (frame.index % options_.restart_frames == 0) {
    for (const auto& [id, followed] : tracks_) tracker_.Stop(id);
    tracks_.clear();
    constexpr std::int64_t kMostTracks = 1'000'000;  // upper bound of tracks between two restarts
    last_number_ = frame.index / options_.restart_frames * kMostTracks;
  }
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

void Follower::Confirm(std::uint64_t track, const Detection& detection, const FeatureSet& features,
                       std::int64_t frame) {
  tracker_.Confirm(track, detection.outline, PointsOf(detection, features));
  Followed& followed = tracks_.at(track);
  followed.last = detection;
  followed.recognised += 1;
  followed.searched_frame = frame;
}

// The region of a visible, confirmed track is searched only every `search_every` frames.
bool Follower::IsDue(const TrackStep& step, const Frame& frame) const {
  const Followed& followed = tracks_.at(step.track);
  return !step.seen() || followed.recognised < options_.least_recognised ||
         frame.index - followed.searched_frame >= options_.search_every;
}

// Assigns a detection of a full-frame search to an open step of the same model, or starts a track.
std::optional<std::int64_t> Follower::Take(const Detection& detection, const FeatureSet& features, std::int64_t frame,
                                           std::vector<TrackStep>& open) {
  std::vector<TrackStep> alike;
  std::ranges::copy_if(open, std::back_inserter(alike),
                       [&](const TrackStep& step) { return tracks_.at(step.track).last.model == detection.model; });
  if (const auto step = StepOf(detection.box, alike, options_.least_overlap); step != alike.end()) {
    Confirm(step->track, detection, features, frame);
    double& surest = tracks_.at(step->track).surest;
    surest = std::max(surest, detection.score);
    const std::uint64_t track = step->track;
    std::erase_if(open, [&](const TrackStep& other) { return other.track == track; });
    return tracks_.at(track).number;
  }
  const TrackStep step = tracker_.Start(detection.outline, PointsOf(detection, features));
  if (step.state != TrackState::kActive) return std::nullopt;
  tracks_[step.track] = {
      .last = detection, .surest = detection.score, .number = ++last_number_, .recognised = 1, .searched_frame = frame};
  return last_number_;
}

// Extracts features of the region only, in frame coordinates; then matches the last view and its neighbours.
void Follower::Search(const Frame& frame, const FrameConditions& conditions, Region& region) const {
  region.features = FeaturesIn(frame.image, region.step.search_box, extractor_);
  if (!region.features || region.features->keypoints.empty()) return;
  const Detection& last = tracks_.at(region.step.track).last;
  const ModelView& view = recognizer_.models()[last.model].views[last.view];
  std::vector<std::size_t> views(view.neighbours.begin(), view.neighbours.end());
  views.push_back(last.view);
  for (Detection& detection : recognizer_.RecognizeViews(*region.features, last.model, views, conditions)) {
    if (IntersectionOverUnion(detection.box, BoxOf(region.step)) < options_.least_overlap) continue;
    detection.score = std::min(detection.score, tracks_.at(region.step.track).surest);
    region.found = std::move(detection);
    return;
  }
}

Seen Follower::Tracked(const TrackStep& step, const Frame& frame) const {
  Seen seen{.detection = tracks_.at(step.track).last, .features = {}, .followed_frames = step.unconfirmed_frames};
  Detection& detection = seen.detection;
  detection.outline = step.outline;
  detection.box = step.box;
  detection.score *= step.support;
  const Pose& last = tracks_.at(step.track).last.pose;
  const Similarity2& moved = step.now_from_template;
  detection.pose.scene_from_template = {moved.scale * last.scene_from_template.scale,
                                        WrapAngle(moved.rotation_rad + last.scene_from_template.rotation_rad),
                                        moved.Apply(last.scene_from_template.translation)};
  detection.pose.scene_from_template_plane = moved.Matrix() * last.scene_from_template_plane;
  // The points keep the order of the matches from which they were made.
  detection.pose.inliers.clear();
  detection.pose.inlier_points.clear();
  seen.features.image_width = frame.image.cols;
  seen.features.image_height = frame.image.rows;
  std::size_t match = 0;
  for (const TrackPoint& point : step.points) {
    while (match < last.inliers.size() && last.inliers[match].model != point.feature) ++match;
    if (match == last.inliers.size()) break;
    detection.pose.inliers.push_back(last.inliers[match]);
    detection.pose.inliers.back().scene = static_cast<std::uint32_t>(seen.features.size());
    if (!last.inlier_points.empty()) detection.pose.inlier_points.push_back(last.inlier_points[match]);
    seen.features.keypoints.push_back(
        {.x = static_cast<float>(point.place.x()), .y = static_cast<float>(point.place.y())});
    ++match;
  }
  return seen;
}

Expected<std::vector<Seen>> Follower::Follow(const Frame& frame, const std::optional<WholeFrame>& whole,
                                             const FrameConditions& conditions) {
  const Frame clean = CleanGrey(frame, impulse_share_);  // over the whole frame: a region has too few pixels for it
  std::vector<TrackStep> open = Step(clean);
  std::vector<Seen> seen;
  if (whole) {
    for (const Detection& detection : whole->detections) {
      const auto number = Take(detection, whole->features, frame.index, open);
      seen.push_back({.detection = detection, .features = whole->features, .track = number});
    }
  }
  std::vector<Region> regions;
  for (TrackStep& step : open) regions.push_back({.step = std::move(step)});
  oneapi::tbb::parallel_for_each(regions, [&](Region& region) {
    if (IsDue(region.step, frame)) Search(clean, conditions, region);
  });
  for (Region& region : regions) {
    if (!region.features) return std::unexpected(std::move(region.features).error());
    const std::uint64_t track = region.step.track;
    if (IsDue(region.step, frame)) tracks_.at(track).searched_frame = frame.index;
    Seen next{};
    if (region.found) {
      next = {.detection = *std::move(region.found), .features = *std::move(region.features)};
    } else if (region.step.seen() && tracks_.at(track).recognised >= options_.least_recognised) {
      next = Tracked(region.step, frame);
    } else {
      continue;
    }
    // Two tracks of one object: keep the first.
    const bool is_double = std::ranges::any_of(seen, [&](const Seen& other) {
      return other.detection.model == next.detection.model &&
             IntersectionOverUnion(other.detection.box, next.detection.box) >= options_.least_overlap;
    });
    if (is_double) {
      tracker_.Stop(track);
      tracks_.erase(track);
      continue;
    }
    next.track = tracks_.at(track).number;
    if (!next.tracked()) Confirm(track, next.detection, next.features, frame.index);
    seen.push_back(std::move(next));
  }
  return seen;
}

}  // namespace victorious
