// Where on Earth an object is, with what is left uncertain.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"

namespace victorious {

/// Where an object is at a moment, and how it moves then.
struct Place {
  GeodeticPoint point;
  double time_s = 0;                            ///< when: the last line's time
  Eigen::Matrix3d covariance_enu_m2;            ///< east, north, up at the point
  std::optional<Eigen::Vector3d> velocity_enu;  ///< m/s; not there where motion was not looked at
  std::optional<Eigen::Matrix3d> velocity_covariance_enu;
  double ce90_m = 0;  ///< radius of the horizontal circle about the point that holds the truth in 90 %
  double le90_m = 0;  ///< the same of height, up and down

  /// False also where motion was not looked at.
  [[nodiscard]] bool Moves() const { return velocity_enu && velocity_enu->norm() > 0; }
};

}  // namespace victorious
