#include "victorious/associate/tracklet_linker.h"

#include <algorithm>
#include <functional>
#include <map>

#include "victorious/geometry/polygon.h"
#include "victorious/associate/object_place.h"
#include "victorious/observe/bearing_observation.h"

namespace victorious {
namespace {

// Length of the trail from which a tracklet's velocity and place are estimated.
constexpr double kTrail_s = 1;

// May leave the frame: a clipped box would seem to move when an object enters or leaves.
Box ExtentOf(const SightingRecord& sighting) {
  return sighting.outline.empty() ? sighting.box : BoundingBox(sighting.outline);
}

Eigen::Vector2d CentreOf(const Box& box) { return {box.x + box.width / 2, box.y + box.height / 2}; }

Box Carried(const Box& box, const Similarity2& map) {
  const Eigen::Vector2d centre = map.Apply(CentreOf(box));
  const double width = map.scale * box.width;
  const double height = map.scale * box.height;
  return {centre.x() - width / 2, centre.y() - height / 2, width, height};
}

}  // namespace

double RunLinker::HistoryS() const { return options_.gap_s + kTrail_s; }

void RunLinker::See(const SightingRecord& sighting, Run& run) {
  std::optional<Sight> sight = sighting.sight;
  if (sight) {
    const auto last = std::ranges::find_if(run.trail.rbegin(), run.trail.rend(),
                                           [](const Seen& seen) { return seen.sight.has_value(); });
    sight->recognition = RecognitionOf(sighting, last != run.trail.rend() ? &*last->sight : nullptr, recognitions_);
  }
  run.track = sighting.track;
  run.trail.push_back({sighting.frame, sighting.time_s, ExtentOf(sighting), std::move(sight)});
  std::erase_if(run.trail, [&](const Seen& seen) { return seen.time_s < sighting.time_s - kTrail_s; });
}

void RunLinker::Resume(std::span<const RunRecord> runs, std::span<const SightingRecord> sightings) {
  std::map<std::int64_t, Run> by_id;
  for (const RunRecord& run : runs)
    by_id[run.id] = {.record = run, .id = run.id, .in_batch = {}, .track = {}, .trail = {}};
  for (const SightingRecord& sighting : sightings) {
    if (const auto run = by_id.find(sighting.run); run != by_id.end()) See(sighting, run->second);
  }
  for (auto& [id, run] : by_id) {
    if (!run.trail.empty()) runs_.push_back(std::move(run));
  }
}

std::optional<std::int64_t> RunLinker::NeededFrom() const {
  std::optional<std::int64_t> first;
  for (const Run& run : runs_) {
    if (!first || run.trail.front().frame < *first) first = run.trail.front().frame;
  }
  return first;
}

void RunLinker::Step(std::int64_t frame, const std::optional<Similarity2>& now_from_before) {
  if (!now_from_before) return;
  for (Run& run : runs_) {
    for (Seen& seen : run.trail) {
      if (seen.frame < frame) seen.box = Carried(seen.box, *now_from_before);
    }
  }
}

// Predicted box at a time: the last box, moved by the camera motion, plus the object's own velocity over the trail.
Box RunLinker::Expected(const Run& run, double time_s) {
  constexpr double kLeastBaseline_s = 0.4;  // below this, box noise dominates the velocity
  const Seen& first = run.trail.front();
  const Seen& last = run.trail.back();
  Box box = last.box;
  const double baseline_s = last.time_s - first.time_s;
  if (baseline_s < kLeastBaseline_s) return box;
  const Eigen::Vector2d gone = (time_s - last.time_s) / baseline_s * (CentreOf(last.box) - CentreOf(first.box));
  box.x += gone.x();
  box.y += gone.y();
  return box;
}

// True if the observation passes the gate of the tracklet's place, under a static or an automatically selected motion
// model. Telemetry's common errors count in full, because they may vary from frame to frame. The error parameters of
// data association may change without a new search (ObjectOptions), so their defaults are used here.
bool RunLinker::CanBeOne(const Run& run, const SightingRecord& sighting) const {
  if (!sighting.sight) return true;
  std::vector<Sight> sights;
  for (const Seen& seen : run.trail) {
    if (seen.sight) sights.push_back(*seen.sight);
  }
  ObjectOptions objects;
  for (const char* motion : {"static", "auto"}) {
    objects.locate.motion = motion;
    const std::optional<Place> place = PlaceOf(sights, objects, objects.flight_share).place;
    if (!place) return true;
    const double off =
        SigmasOff(*sighting.sight, At(*place, sighting.time_s), objects.identity_slack_m, objects.locate, 1);
    if (off <= options_.gate_sigma) return true;
  }
  return false;
}

std::vector<std::optional<std::size_t>> RunLinker::RunsOf(const std::vector<SightingRecord>& sightings) const {
  std::vector<std::optional<std::size_t>> run_of(sightings.size());
  std::vector<bool> taken(runs_.size(), false);
  const double time_s = sightings.front().time_s;
  const auto may_grow = [&](std::size_t r, const SightingRecord& sighting) {
    const Run& run = runs_[r];
    return !taken[r] && run.record.model == sighting.model && run.record.last_time_s + options_.gap_s >= time_s;
  };
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    for (std::size_t r = 0; r < runs_.size() && sightings[s].track && !run_of[s]; ++r) {
      if (runs_[r].track != sightings[s].track || !may_grow(r, sightings[s])) continue;
      run_of[s] = r;
      taken[r] = true;
    }
  }
  // Remaining sightings: greedy assignment by overlap, one sighting per tracklet.
  struct Pair {
    double overlap;
    std::size_t sighting, run;
  };
  std::vector<Pair> pairs;
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    for (std::size_t r = 0; r < runs_.size() && !run_of[s]; ++r) {
      if (!may_grow(r, sightings[s])) continue;
      const double overlap = IntersectionOverUnion(Expected(runs_[r], time_s), ExtentOf(sightings[s]));
      if (overlap > 0 && overlap >= options_.least_overlap) pairs.push_back({overlap, s, r});
    }
  }
  std::ranges::stable_sort(pairs, std::greater{}, &Pair::overlap);
  for (const Pair& pair : pairs) {
    if (run_of[pair.sighting] || taken[pair.run] || !CanBeOne(runs_[pair.run], sightings[pair.sighting])) continue;
    run_of[pair.sighting] = pair.run;
    taken[pair.run] = true;
  }
  return run_of;
}

void RunLinker::Link(std::vector<SightingRecord> sightings, IndexBatch& batch) {
  if (sightings.empty()) return;
  const double time_s = sightings.front().time_s;
  // Drops tracklets that cannot grow any more, unless the store still has to assign their ids.
  std::erase_if(runs_,
                [&](const Run& run) { return !run.in_batch && run.record.last_time_s + options_.gap_s < time_s; });
  std::vector<std::optional<std::size_t>> run_of = RunsOf(sightings);
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    SightingRecord& sighting = sightings[s];
    if (!run_of[s]) {
      run_of[s] = runs_.size();
      runs_.push_back({.record = {.video = sighting.video, .model = sighting.model, .first_time_s = sighting.time_s},
                       .id = std::nullopt,
                       .in_batch = std::nullopt,
                       .track = std::nullopt,
                       .trail = {}});
    }
    Run& run = runs_[*run_of[s]];
    run.record.score = std::max(run.record.score, sighting.score);
    run.record.frames += 1;
    run.record.last_time_s = sighting.time_s;
    See(sighting, run);
    if (!run.in_batch) {
      run.in_batch = batch.runs.size();
      batch.runs.push_back({.id = run.id, .run = {}});
    }
    batch.runs[*run.in_batch].run = run.record;
    batch.sightings.push_back({.run_update = *run.in_batch, .sighting = std::move(sighting)});
  }
}

void RunLinker::Committed(std::span<const std::int64_t> ids) {
  for (Run& run : runs_) {
    if (!run.in_batch) continue;
    run.id = ids[*run.in_batch];
    run.record.id = *run.id;
    run.in_batch.reset();
  }
}

void RunOptions::ListFields(FieldList& fields) {
  fields.Add("gap_s", gap_s,
             {.min = 0,
              .max = 3600,
              .unit = "s",
              .reason = "maximum time from a tracklet's last sighting to the next; raised to 2.5 searched frames or "
                        "the frames that a track may miss, if these are longer"});
  fields.Add("least_overlap", least_overlap,
             {.min = 0,
              .max = 1,
              .reason = "minimum intersection over union of a sighting's box with the tracklet's predicted box, which "
                        "includes camera and object motion"});
  fields.Add("gate_sigma", gate_sigma,
             {.min = 0,
              .max = 1e6,
              .reason = "a sighting starts a new tracklet if the Mahalanobis distance of its line of sight and range "
                        "to the tracklet's place exceeds this, unless it has the same track"});
}

}  // namespace victorious
