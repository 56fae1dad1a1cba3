// What one sighting tells of the object's place: along which line it was seen, from how far, how it was turned.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/types/line_of_sight.h"

namespace victorious {

struct Sight {
  LineOfSight line;                          ///< to the middle of the object's bounding box
  std::optional<double> heading_rad;         ///< of the object's front, clockwise from north
  std::optional<double> sigma_position_m;    ///< of the camera's place, along each axis, where telemetry tells
  std::optional<double> sigma_attitude_rad;  ///< of the camera's attitude, about each axis, where telemetry tells
  /// Which recognition it rests on: sights of one that were followed from it, and it itself, err alike by as much as it
  /// errs. 0: on its own.
  std::int64_t recognition = 0;
};

}  // namespace victorious
