#include "victorious/place/associate/tracklet_linker.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "victorious/geometry/polygon.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/observe/bearing_observation.h"

namespace victorious {
namespace {

// Minimum length of a trail for a velocity, s: below it, box noise dominates. Chosen, not fitted.
constexpr double kMinBaseline_s = 0.4;

// May leave the frame: a clipped box would seem to move when an object enters or leaves.
Box SightingExtent(const SightingRecord& sighting) {
  return sighting.outline.empty() ? sighting.box : BoundingBox(sighting.outline);
}

Eigen::Vector2d CentreOf(const Box& box) { return {box.x + box.width / 2, box.y + box.height / 2}; }

Box TransformBox(const Box& box, const Similarity2& map) {
  const Eigen::Vector2d centre = map.Apply(CentreOf(box));
  const double width = map.scale * box.width;
  const double height = map.scale * box.height;
  return {centre.x() - width / 2, centre.y() - height / 2, width, height};
}

}  // namespace

TrackletLinker::TrackletLinker(const TrackletOptions& options, ObjectOptions objects)
    : options_(options), objects_(std::move(objects)) {
  objects_.ground
      .reset();  // places of one second are compared with each other: an error of the ground would not cancel
}

double TrackletLinker::HistorySeconds() const { return options_.gap_s + kTrackletTrail_s; }

void TrackletLinker::AppendToTrail(const SightingRecord& sighting, GrowingTracklet& tracklet) {
  std::optional<BearingObservation> observation = sighting.observation;
  if (observation) {
    const auto last = std::ranges::find_if(tracklet.trail.rbegin(), tracklet.trail.rend(),
                                           [](const TrailEntry& seen) { return seen.observation.has_value(); });
    observation->recognition_id =
        NextRecognitionId(sighting, last != tracklet.trail.rend() ? &*last->observation : nullptr, recognitions_);
  }
  tracklet.track = sighting.track;
  tracklet.trail.push_back({sighting.frame, sighting.time_s, SightingExtent(sighting), std::move(observation)});
  std::erase_if(tracklet.trail,
                [&](const TrailEntry& seen) { return seen.time_s < sighting.time_s - kTrackletTrail_s; });
}

void TrackletLinker::Resume(std::span<const TrackletRecord> tracklets, std::span<const SightingRecord> sightings) {
  std::map<std::int64_t, GrowingTracklet> by_id;
  for (const TrackletRecord& tracklet : tracklets)
    by_id[tracklet.id] = {.record = tracklet, .id = tracklet.id, .in_batch = {}, .track = {}, .trail = {}};
  for (const SightingRecord& sighting : sightings) {
    if (const auto tracklet = by_id.find(sighting.tracklet); tracklet != by_id.end())
      AppendToTrail(sighting, tracklet->second);
  }
  for (auto& [id, tracklet] : by_id) {
    if (!tracklet.trail.empty()) tracklets_.push_back(std::move(tracklet));
  }
}

std::optional<std::int64_t> TrackletLinker::FirstRequiredFrame() const {
  std::optional<std::int64_t> first;
  for (const GrowingTracklet& tracklet : tracklets_) {
    if (!first || tracklet.trail.front().frame < *first) first = tracklet.trail.front().frame;
  }
  return first;
}

void TrackletLinker::Step(std::int64_t frame, const std::optional<Similarity2>& now_from_before) {
  if (!now_from_before) return;
  for (GrowingTracklet& tracklet : tracklets_) {
    for (TrailEntry& seen : tracklet.trail) {
      if (seen.frame < frame) seen.box = TransformBox(seen.box, *now_from_before);
    }
  }
}

// Predicted box at a time: the last box, moved by the camera motion, plus the object's own velocity over the trail.
Box TrackletLinker::PredictBox(const GrowingTracklet& tracklet, double time_s) {
  const TrailEntry& first = tracklet.trail.front();
  const TrailEntry& last = tracklet.trail.back();
  Box box = last.box;
  const double baseline_s = last.time_s - first.time_s;
  if (baseline_s < kMinBaseline_s) return box;
  const Eigen::Vector2d displacement = (time_s - last.time_s) / baseline_s * (CentreOf(last.box) - CentreOf(first.box));
  box.x += displacement.x();
  box.y += displacement.y();
  return box;
}

// True if the observation passes the gate of the tracklet's place, under a static or an automatically selected motion
// model. Telemetry's common errors count in full, because they may vary from frame to frame.
bool TrackletLinker::IsConsistent(const GrowingTracklet& tracklet, const SightingRecord& sighting) const {
  if (!sighting.observation) return true;
  std::vector<BearingObservation> observations;
  for (const TrailEntry& seen : tracklet.trail) {
    if (seen.observation) observations.push_back(*seen.observation);
  }
  ObjectOptions objects = objects_;
  for (const MotionModel motion : {MotionModel::kStatic, MotionModel::kAuto}) {
    objects.locate.motion = motion;
    const std::optional<Geolocation> place = EstimatePlace(observations, objects, kFlightErrorFraction).place;
    if (!place) return true;
    const double off = MahalanobisDistance(*sighting.observation, PredictPlace(*place, sighting.time_s), kMergeSlack_m,
                                           objects.locate, 1);
    if (off <= kTrackletGateSigma) return true;
  }
  return false;
}

std::vector<std::optional<std::size_t>> TrackletLinker::AssignTracklets(
    const std::vector<SightingRecord>& sightings) const {
  std::vector<std::optional<std::size_t>> tracklet_of(sightings.size());
  std::vector<bool> taken(tracklets_.size(), false);
  const double time_s = sightings.front().time_s;
  const auto is_candidate = [&](std::size_t r, const SightingRecord& sighting) {
    const GrowingTracklet& tracklet = tracklets_[r];
    return !taken[r] && tracklet.record.model == sighting.model &&
           tracklet.record.last_time_s + options_.gap_s >= time_s;
  };
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    for (std::size_t r = 0; r < tracklets_.size() && sightings[s].track && !tracklet_of[s]; ++r) {
      if (tracklets_[r].track != sightings[s].track || !is_candidate(r, sightings[s])) continue;
      tracklet_of[s] = r;
      taken[r] = true;
    }
  }
  // Remaining sightings: greedy assignment by overlap, one sighting per tracklet.
  struct Pair {
    double overlap;
    std::size_t sighting, tracklet;
  };
  std::vector<Pair> pairs;
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    for (std::size_t r = 0; r < tracklets_.size() && !tracklet_of[s]; ++r) {
      if (!is_candidate(r, sightings[s])) continue;
      if (options_.are_tracks_given && tracklets_[r].track && sightings[s].track) continue;  // two tracks
      const double overlap = IntersectionOverUnion(PredictBox(tracklets_[r], time_s), SightingExtent(sightings[s]));
      if (overlap > 0 && overlap >= options_.min_overlap) pairs.push_back({overlap, s, r});
    }
  }
  std::ranges::stable_sort(pairs, std::greater{}, &Pair::overlap);
  for (const Pair& pair : pairs) {
    if (tracklet_of[pair.sighting] || taken[pair.tracklet] ||
        !IsConsistent(tracklets_[pair.tracklet], sightings[pair.sighting]))
      continue;
    tracklet_of[pair.sighting] = pair.tracklet;
    taken[pair.tracklet] = true;
  }
  return tracklet_of;
}

void TrackletLinker::Link(std::vector<SightingRecord> sightings, IndexBatch& batch) {
  if (sightings.empty()) return;
  const double time_s = sightings.front().time_s;
  // Drops tracklets that cannot grow any more, unless the store still has to assign their ids.
  std::erase_if(tracklets_, [&](const GrowingTracklet& tracklet) {
    return !tracklet.in_batch && tracklet.record.last_time_s + options_.gap_s < time_s;
  });
  std::vector<std::optional<std::size_t>> tracklet_of = AssignTracklets(sightings);
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    SightingRecord& sighting = sightings[s];
    if (!tracklet_of[s]) {
      tracklet_of[s] = tracklets_.size();
      tracklets_.push_back(
          {.record = {.video = sighting.video, .model = sighting.model, .first_time_s = sighting.time_s},
           .id = std::nullopt,
           .in_batch = std::nullopt,
           .track = std::nullopt,
           .trail = {}});
    }
    GrowingTracklet& tracklet = tracklets_[*tracklet_of[s]];
    tracklet.record.score = std::max(tracklet.record.score, sighting.score);
    tracklet.record.frames += 1;
    tracklet.record.last_time_s = sighting.time_s;
    AppendToTrail(sighting, tracklet);
    if (!tracklet.in_batch) {
      tracklet.in_batch = batch.tracklets.size();
      batch.tracklets.push_back({.id = tracklet.id, .tracklet = {}});
    }
    batch.tracklets[*tracklet.in_batch].tracklet = tracklet.record;
    batch.sightings.push_back({.tracklet_update = *tracklet.in_batch, .sighting = std::move(sighting)});
  }
}

void TrackletLinker::SetCommittedIds(std::span<const std::int64_t> ids) {
  for (GrowingTracklet& tracklet : tracklets_) {
    if (!tracklet.in_batch) continue;
    tracklet.id = ids[*tracklet.in_batch];
    tracklet.record.id = *tracklet.id;
    tracklet.in_batch.reset();
  }
}

void TrackletOptions::ListFields(FieldList& fields) {
  fields.Add("gap_s", gap_s,
             {.min = 0,
              .max = 3600,
              .unit = "s",
              .reason = "maximum time from a tracklet's last sighting to the next; raised to 2.5 searched frames or "
                        "the frames that a track may miss, if these are longer"});
}

}  // namespace victorious
