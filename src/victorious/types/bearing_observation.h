// The bearing observation of one sighting: the line of sight with its range, and the object's heading.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/types/line_of_sight.h"

namespace victorious {

/// Standard deviations of telemetry's errors as the lines of sight of the flight show them.
struct TelemetrySigmas {
  double row_position_m = 0;    ///< along each axis, independent from row to row
  double row_attitude_rad = 0;  ///< about each axis, independent from row to row
  double common_position = 1;   ///< of the error common to the flight, over the supposed one
  double common_attitude = 1;   ///< the same
};

struct BearingObservation {
  LineOfSight line;                          ///< to the centre of the object's bounding box
  std::optional<double> heading_rad;         ///< of the object's front, clockwise from north
  std::optional<double> sigma_position_m;    ///< of the camera position along each axis, if telemetry gives it
  std::optional<double> sigma_attitude_rad;  ///< of the camera attitude about each axis, if telemetry gives it
  /// Number of the recognition that this observation was made or tracked from. Observations of equal number share that
  /// recognition's error. 0: an independent observation.
  std::int64_t recognition_id = 0;
  /// Set by data association, in memory only; std::nullopt: what is supposed, or stated above.
  std::optional<TelemetrySigmas> flight_sigmas = std::nullopt;
};

}  // namespace victorious
