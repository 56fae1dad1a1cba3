#include "victorious/pipeline/run_linker.h"

#include <algorithm>
#include <functional>
#include <map>

namespace victorious {

void RunLinker::Resume(std::span<const RunRecord> runs, std::span<const SightingRecord> sightings) {
  std::map<std::int64_t, const RunRecord*> by_id;
  for (const RunRecord& run : runs) by_id[run.id] = &run;
  std::map<std::int64_t, Box> last_boxes;
  for (const SightingRecord& sighting : sightings) last_boxes[sighting.run] = sighting.box;
  for (const auto& [id, box] : last_boxes) {
    if (const auto run = by_id.find(id); run != by_id.end()) {
      runs_.push_back({.record = *run->second, .id = id, .in_batch = std::nullopt, .last_box = box});
    }
  }
}

void RunLinker::Link(std::vector<SightingRecord> sightings, IndexBatch& batch) {
  if (sightings.empty()) return;
  const double time_s = sightings.front().time_s;
  // Runs that can grow no more are let go, unless the batch still has to be told their ids.
  std::erase_if(runs_,
                [&](const Run& run) { return !run.in_batch && run.record.last_time_s + options_.gap_s < time_s; });

  // Pairs of sighting and run, the best overlap first, each side once.
  struct Pair {
    double overlap;
    std::size_t sighting, run;
  };
  std::vector<Pair> pairs;
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Run& run = runs_[r];
      if (run.record.model != sightings[s].model || run.record.last_time_s + options_.gap_s < time_s) continue;
      const double overlap = IntersectionOverUnion(run.last_box, sightings[s].box);
      if (overlap > 0 && overlap >= options_.least_overlap) pairs.push_back({overlap, s, r});
    }
  }
  std::ranges::stable_sort(pairs, std::greater{}, &Pair::overlap);
  std::vector<std::optional<std::size_t>> run_of(sightings.size());
  std::vector<bool> taken(runs_.size(), false);
  for (const Pair& pair : pairs) {
    if (run_of[pair.sighting] || taken[pair.run]) continue;
    run_of[pair.sighting] = pair.run;
    taken[pair.run] = true;
  }

  for (std::size_t s = 0; s < sightings.size(); ++s) {
    SightingRecord& sighting = sightings[s];
    if (!run_of[s]) {
      run_of[s] = runs_.size();
      runs_.push_back({.record = {.video = sighting.video, .model = sighting.model, .first_time_s = sighting.time_s},
                       .id = std::nullopt,
                       .in_batch = std::nullopt,
                       .last_box = {}});
    }
    Run& run = runs_[*run_of[s]];
    run.record.score = std::max(run.record.score, sighting.score);
    run.record.frames += 1;
    run.record.last_time_s = sighting.time_s;
    run.last_box = sighting.box;
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

}  // namespace victorious
