// The direction of a line of sight.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "victorious/types/line_of_sight.h"

namespace victorious {

/// Unit length; east, north, up at the camera.
[[nodiscard]] inline Eigen::Vector3d DirectionOf(const LineOfSight& line) {
  const double level = std::cos(line.elevation_rad);
  return {level * std::sin(line.azimuth_rad), level * std::cos(line.azimuth_rad), std::sin(line.elevation_rad)};
}

}  // namespace victorious
