// Figure 4.5 (the architecture): the list of objects over time, with the frames in which each object is active and the
// component that observed it.
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>

#include <fmt/format.h>

#include "experiments/indexed_movie.h"
#include "experiments/system_experiments.h"
#include "victorious/lab/evaluate/reported.h"
#include "victorious/store/catalogue.h"

namespace victorious {
namespace {

// The component that observed an object in a frame.
enum class ObservedBy { kWholeFrame, kRegion, kTracker };

struct Timeline {
  std::string name;  ///< "jeep 3": model and id
  std::int64_t runs = 0;
  std::map<std::int64_t, ObservedBy> frames;
};

ObservedBy ClassifySighting(const SightingRecord& sighting, const IndexOptions& options) {
  if (sighting.source != SightingSource::kRecognised) return ObservedBy::kTracker;
  const bool whole =
      sighting.frame % options.every == 0 || sighting.frame % options.follow.restart_interval_frames == 0;
  return whole ? ObservedBy::kWholeFrame : ObservedBy::kRegion;
}

Expected<std::vector<Timeline>> ReadTimelines(const MovieWithTruth& movie, const ExperimentSettings& settings) {
  const IndexOptions options = TrackingIndexOptions();
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, IndexMovie(movie, options, settings));
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(*store, {}));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store->Objects({}));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SightingRecord> sightings, store->Sightings({}));
  std::map<std::int64_t, Timeline> timelines;
  for (const ObjectRecord& object : objects) {
    timelines[object.id] = {.name = fmt::format("{} {}", catalogue.Model(object.model)->name, object.id),
                            .runs = static_cast<std::int64_t>(object.tracklets.size()),
                            .frames = {}};
  }
  for (const SightingRecord& sighting : sightings) {
    timelines[sighting.object].frames[sighting.frame] = ClassifySighting(sighting, options);
  }
  std::vector<Timeline> all;
  for (auto& [id, timeline] : timelines) {
    if (!timeline.frames.empty()) all.push_back(std::move(timeline));
  }
  std::ranges::sort(all, {}, [](const Timeline& one) { return one.frames.begin()->first; });
  return all;
}

double Count(const Timeline& timeline, ObservedBy by) {
  return static_cast<double>(std::ranges::count(timeline.frames, by, [](const auto& one) { return one.second; }));
}

// The number of intervals of consecutive frames with an observation.
double CountIntervals(const Timeline& timeline) {
  double intervals = 0;
  std::int64_t before = -2;
  for (const auto& [frame, by] : timeline.frames) {
    intervals += frame > before + 1 ? 1 : 0;
    before = frame;
  }
  return intervals;
}

}  // namespace

Expected<Report> RunFigure45(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MovieWithTruth> movies, SimulateScenes({"straight"}, settings));
  Report report{.title = "The list of objects over time",
                .columns = {"movie", "object", "first frame", "last frame", "frames seen", "in whole-frame searches",
                            "in tracked region", "by the tracker alone", "frames missed", "active intervals",
                            "tracklets merged"}};
  for (const MovieWithTruth& movie : movies) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Timeline> timelines, ReadTimelines(movie, settings));
    for (const Timeline& timeline : timelines) {
      const auto first = static_cast<double>(timeline.frames.begin()->first);
      const auto last = static_cast<double>(timeline.frames.rbegin()->first);
      const auto seen = static_cast<double>(timeline.frames.size());
      report.rows.push_back({movie.name, timeline.name, first, last, seen, Count(timeline, ObservedBy::kWholeFrame),
                             Count(timeline, ObservedBy::kRegion), Count(timeline, ObservedBy::kTracker),
                             last - first + 1 - seen, CountIntervals(timeline), static_cast<double>(timeline.runs)});
    }
    if (!report.plot.lines.empty()) continue;
    report.plot = {.title = fmt::format("Objects of {}: active where there is a point", movie.name),
                   .x = {.label = "frame"},
                   .y = {.label = "object, in the order of the table",
                         .low = -1,
                         .high = static_cast<double>(timelines.size()) + 0.5},
                   .lines = {{.name = "whole frame searched", .points = {}, .connected = false},
                             {.name = "region searched", .points = {}, .connected = false},
                             {.name = "tracker alone", .points = {}, .connected = false}}};
    for (std::size_t i = 0; i < timelines.size(); ++i) {
      for (const auto& [frame, by] : timelines[i].frames) {
        report.plot.lines[static_cast<std::size_t>(by)].points.push_back(
            {static_cast<double>(frame), static_cast<double>(i + 1)});
      }
    }
  }
  report.notes = {
      fmt::format("Movie: {}; a whole-frame search in every {}th frame.", DescribeMovies(movies),
                  TrackingIndexOptions().every),
      "New objects are detected in whole-frame searches. Between these, active objects are confirmed by the recogniser "
      "in the tracked region, or tracked only. An object that leaves the frame becomes inactive."};
  return report;
}

}  // namespace victorious
