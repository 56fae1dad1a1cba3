// The geolocation of an object: position, velocity and their covariances. Made by geolocate/.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"

namespace victorious {

/// Position at one time and, if estimated, velocity.
struct Geolocation {
  GeodeticPoint point;
  double time_s = 0;                            ///< time of the last line of sight
  Eigen::Matrix3d covariance_enu_m2;            ///< east, north, up at `point`
  std::optional<Eigen::Vector3d> velocity_enu;  ///< m/s; nullopt if motion was not estimated
  std::optional<Eigen::Matrix3d> velocity_covariance_enu;
  double ce90_m = 0;  ///< CE90: radius of the horizontal circle that contains the true position with 90 %
  double le90_m = 0;  ///< LE90: half the vertical interval that contains the true height with 90 %

  /// True if the velocity is estimated and not zero; false if motion was not estimated.
  [[nodiscard]] bool IsMoving() const { return velocity_enu && velocity_enu->norm() > 0; }
};

}  // namespace victorious
