// The bearing observation of one sighting: the line of sight with its range, and the object's heading.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/types/line_of_sight.h"

namespace victorious {

struct BearingObservation {
  LineOfSight line;                          ///< to the centre of the object's bounding box
  std::optional<double> heading_rad;         ///< of the object's front, clockwise from north
  std::optional<double> sigma_position_m;    ///< of the camera position along each axis, if telemetry gives it
  std::optional<double> sigma_attitude_rad;  ///< of the camera attitude about each axis, if telemetry gives it
  /// Number of the recognition that this observation was made or tracked from. Observations of equal number share that
  /// recognition's error. 0: an independent observation.
  std::int64_t recognition_id = 0;
};

}  // namespace victorious
