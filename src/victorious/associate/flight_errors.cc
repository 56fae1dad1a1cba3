#include "victorious/associate/flight_errors.h"

#include <cmath>

#include <fmt/format.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

std::string DescribeHeading(const HeadingError& error) {
  return fmt::format(
      "the lines of sight in {} tracks meet only if the yaw of the telemetry is {:.1f} degrees too {}: places are "
      "corrected by it",
      error.objects, std::abs(DegreesFromRadians(error.error_rad)), error.error_rad > 0 ? "large" : "small");
}

// The focal length is proportional to the ranges: too short ranges follow from too wide a field of view.
std::string DescribeRange(const RangeFactor& range) {
  const double percent = 100 * std::abs(range.factor - 1);
  return fmt::format(
      "the lines of sight of {} objects meet {:.0f} % {} than their sizes imply: the field of view is about {:.0f} % "
      "too {}; ranges are corrected by it",
      range.objects, percent, range.factor > 1 ? "farther" : "nearer", percent, range.factor > 1 ? "wide" : "narrow");
}

}  // namespace

std::map<std::int64_t, FlightErrors> FlightErrorCache::Correct(std::span<ObservedTracklet> tracklets,
                                                               const ObjectOptions& options) {
  std::map<std::int64_t, std::vector<ObservedTracklet*>> of_video;
  for (ObservedTracklet& tracklet : tracklets) of_video[tracklet.record.video].push_back(&tracklet);
  std::map<std::int64_t, FlightErrors> all;
  const std::lock_guard lock(mutex_);
  for (const auto& [video, seen] : of_video) {
    Contents contents;
    for (const ObservedTracklet* tracklet : seen)
      contents.emplace_back(tracklet->record.id, tracklet->observations.size());
    const auto known = of_video_.find(video);
    const bool changed = known == of_video_.end() || known->second.contents != contents;
    std::vector<ObservedTracklet> own;
    for (ObservedTracklet* tracklet : seen) own.push_back(std::move(*tracklet));
    FlightErrors errors = changed ? FlightErrors() : known->second.errors;
    if (changed) {
      errors.heading = EstimateHeadingError(own);
      ++estimates_;
    }
    if (errors.heading) TurnBack(*errors.heading, own);
    if (changed) errors.range = EstimateRangeFactor(own, options);
    if (errors.range) ScaleRanges(*errors.range, own);
    for (std::size_t i = 0; i < seen.size(); ++i) *seen[i] = std::move(own[i]);
    of_video_[video] = {std::move(contents), errors};
    if (errors.heading || errors.range) all[video] = errors;
  }
  return all;
}

std::int64_t FlightErrorCache::estimates() const {
  const std::lock_guard lock(mutex_);
  return estimates_;
}

std::vector<std::string> Describe(const FlightErrors& errors) {
  std::vector<std::string> lines;
  if (errors.heading) lines.push_back(DescribeHeading(*errors.heading));
  if (errors.range) lines.push_back(DescribeRange(*errors.range));
  return lines;
}

}  // namespace victorious
