// A line of sight to an object: camera position, direction and, if known, range. Input of geolocate/.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"

namespace victorious {

/// The change of a line of sight by one standard deviation of an error of telemetry's clock: fully correlated between
/// the lines of one flight.
struct ClockShift {
  Eigen::Vector3d camera_enu_m = Eigen::Vector3d::Zero();
  double azimuth_rad = 0;
  double elevation_rad = 0;
};

/// The change of a line of sight by one standard deviation of an error of the focal length: fully correlated between
/// the lines of one flight. A longer focal length means a longer range, and a line nearer to the optical axis.
struct FocalShift {
  double sigma = 0;          ///< of the logarithm of the focal length, and so of the range
  double azimuth_rad = 0;    ///< by one standard deviation
  double elevation_rad = 0;  ///< the same
};

struct LineOfSight {
  double time_s = 0;
  GeodeticPoint camera;                 ///< the camera's centre of projection
  double azimuth_rad = 0;               ///< clockwise from north, at the camera
  double elevation_rad = 0;             ///< above the horizon, at the camera
  std::optional<double> range_m;        ///< from the apparent size (the thesis's distance prior)
  std::optional<double> sigma_rad;      ///< standard deviation of each angle; independent between lines
  std::optional<double> sigma_range_m;  ///< standard deviation of the range; independent between lines
  std::optional<ClockShift> clock_shift = std::nullopt;
  std::optional<FocalShift> focal_shift = std::nullopt;
};

}  // namespace victorious
