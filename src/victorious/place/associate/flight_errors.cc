#include "victorious/place/associate/flight_errors.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "victorious/base/count_text.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

std::string DescribeHeading(const HeadingError& error) {
  return fmt::format(
      "the lines of sight in {} tracks meet only if the yaw of the telemetry is {:.1f} degrees too {}: places are "
      "corrected by it",
      error.objects, std::abs(DegreesFromRadians(error.error_rad)), error.error_rad > 0 ? "large" : "small");
}

// A smaller correction is within what telemetry promises.
constexpr double kMinSaid = 0.03;

std::string DescribeFocal(const FocalError& error) {
  return fmt::format(
      "the views of {} objects turn as if the field of view were {:.0f} % too {}: lines of sight and ranges are "
      "corrected by it",
      error.objects, 100 * std::abs(std::expm1(error.log_factor)), error.log_factor > 0 ? "wide" : "narrow");
}

// The focal length is proportional to the ranges: too short ranges follow from too wide a field of view.
std::string DescribeRange(const RangeFactor& range) {
  const double percent = 100 * std::abs(range.factor - 1);
  return fmt::format(
      "the lines of sight of {} objects meet {:.0f} % {} than their sizes imply: the field of view is about {:.0f} % "
      "too {}; ranges are corrected by it",
      range.objects, percent, range.factor > 1 ? "farther" : "nearer", percent, range.factor > 1 ? "wide" : "narrow");
}

std::string DescribeLength(const LengthError& length, const std::map<std::int64_t, std::string>& models) {
  const auto name = models.find(length.model);
  return fmt::format(
      "{}: {} would move with the camera, and {} if the model is {:.2f} times too {}: places are corrected by it; is "
      "the file in another unit? give --length",
      name == models.end() ? "a model" : name->second, CountText(length.objects, "track"),
      length.objects == 1 ? "stands still" : "stand still", std::max(length.factor, 1 / length.factor),
      length.factor < 1 ? "long" : "short");
}

void CorrectRanges(const FlightErrors& errors, std::span<ObservedTracklet> tracklets) {
  CorrectLengths(errors.lengths, tracklets);
  if (!errors.range) return;
  for (ObservedTracklet& tracklet : tracklets) ScaleRanges(errors.range->factor, tracklet);
}

}  // namespace

FlightEstimate CorrectFlight(std::span<ObservedTracklet> tracklets, const ObjectOptions& options) {
  FlightEstimate estimate;
  estimate.errors.heading = EstimateHeadingError(tracklets);
  if (estimate.errors.heading) TurnBack(*estimate.errors.heading, tracklets);
  estimate.errors.focal = EstimateFocalError(tracklets);
  if (estimate.errors.focal) CorrectFocalLength(*estimate.errors.focal, tracklets);
  estimate.comparisons = CompareRanges(tracklets, options);
  estimate.errors.range = EstimateRangeFactor(tracklets, estimate.comparisons);
  estimate.errors.lengths = FindLengthErrors(tracklets, estimate.comparisons, options);
  CorrectRanges(estimate.errors, tracklets);
  estimate.errors.telemetry = EstimateTelemetryErrors(tracklets, options);
  if (estimate.errors.telemetry) SetTelemetryErrors(*estimate.errors.telemetry, options, tracklets);
  const bool are_lines_changed = estimate.errors.range || !estimate.errors.lengths.empty() || estimate.errors.telemetry;
  if (are_lines_changed) estimate.comparisons.clear();
  return estimate;
}

void Correct(const FlightErrors& errors, const ObjectOptions& options, std::span<ObservedTracklet> tracklets) {
  if (errors.heading) TurnBack(*errors.heading, tracklets);
  if (errors.focal) CorrectFocalLength(*errors.focal, tracklets);
  CorrectRanges(errors, tracklets);
  if (errors.telemetry) SetTelemetryErrors(*errors.telemetry, options, tracklets);
}

std::vector<std::string> Describe(const FlightErrors& errors, const std::map<std::int64_t, std::string>& models) {
  std::vector<std::string> lines;
  if (errors.heading) lines.push_back(DescribeHeading(*errors.heading));
  if (errors.focal && std::abs(errors.focal->log_factor) >= kMinSaid) lines.push_back(DescribeFocal(*errors.focal));
  if (errors.range) lines.push_back(DescribeRange(*errors.range));
  for (const LengthError& length : errors.lengths) lines.push_back(DescribeLength(length, models));
  return lines;
}

}  // namespace victorious
