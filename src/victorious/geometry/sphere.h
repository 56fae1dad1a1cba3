// A sphere in space.
#pragma once

#include <Eigen/Core>

namespace victorious {

/// Metres, in the frame of its user.
struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
};

}  // namespace victorious
