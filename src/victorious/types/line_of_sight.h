// A line of sight to an object: camera position, direction and, if known, range. Input of geolocate/.
#pragma once

#include <optional>

#include "victorious/geometry/geodesy.h"

namespace victorious {

struct LineOfSight {
  double time_s = 0;
  GeodeticPoint camera;                 ///< the camera's centre of projection
  double azimuth_rad = 0;               ///< clockwise from north, at the camera
  double elevation_rad = 0;             ///< above the horizon, at the camera
  std::optional<double> range_m;        ///< from the apparent size (the thesis's distance prior)
  std::optional<double> sigma_rad;      ///< standard deviation of each angle; independent between lines
  std::optional<double> sigma_range_m;  ///< standard deviation of the range; independent between lines
};

}  // namespace victorious
