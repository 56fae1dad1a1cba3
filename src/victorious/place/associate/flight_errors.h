// The errors of flights that their own sightings contradict: yaw (heading_error.h), focal length (focal_error.h), then
// ranges (range_factor.h) and the lengths of models (length_error.h); and the sizes of those that are left
// (telemetry_errors.h).
// They are properties of a video's tracklets alone.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/place/associate/focal_error.h"
#include "victorious/place/associate/heading_error.h"
#include "victorious/place/associate/length_error.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/observed_tracklet.h"
#include "victorious/place/associate/range_factor.h"
#include "victorious/place/associate/telemetry_errors.h"

namespace victorious {

struct FlightErrors {
  std::optional<HeadingError> heading;
  std::optional<FocalError> focal;
  std::optional<RangeFactor> range;
  std::vector<LengthError> lengths;  ///< by model
  std::optional<TelemetryErrors> telemetry;
};

/// The errors of a flight, and what was computed on the way.
struct FlightEstimate {
  FlightErrors errors;
  std::vector<RangeComparison> comparisons;  ///< one a tracklet; empty if `errors` changes the lines after it
};

/// Estimates the errors of one flight, and corrects its tracklets by them.
/// @param tracklets  of one video, with their content
[[nodiscard]] FlightEstimate CorrectFlight(std::span<ObservedTracklet> tracklets, const ObjectOptions& options);

/// Corrects tracklets by the errors of their flight.
void Correct(const FlightErrors& errors, const ObjectOptions& options, std::span<ObservedTracklet> tracklets);

/// What the errors of one video mean, one line each.
/// @param models  names, by id
[[nodiscard]] std::vector<std::string> Describe(const FlightErrors& errors,
                                                const std::map<std::int64_t, std::string>& models);

}  // namespace victorious
