// A line of sight: from where, in which direction, and if known how far away, an object was seen.
#pragma once

#include <optional>

#include "victorious/geometry/geodesy.h"

namespace victorious {

struct LineOfSight {
  double time_s = 0;
  GeodeticPoint camera;                 ///< its centre of projection
  double azimuth_rad = 0;               ///< clockwise from north, at the camera
  double elevation_rad = 0;             ///< above the horizon, at the camera
  std::optional<double> range_m;        ///< from the apparent size: the thesis's distance prior
  std::optional<double> sigma_rad;      ///< of each of the two angles, independent from line to line
  std::optional<double> sigma_range_m;  ///< of the range, independent from line to line
};

}  // namespace victorious
