// Rotation vectors (axis times angle in radians): the exponential and logarithmic maps of SO(3).
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious {

inline Eigen::Quaterniond RotationFromVector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (!(angle > 0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

/// The rotation vector of the shorter rotation: length at most pi.
inline Eigen::Vector3d VectorFromRotation(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();  // of half the angle
  if (!(sine > 0)) return Eigen::Vector3d::Zero();
  const double half = rotation.w() < 0 ? std::atan2(-sine, -rotation.w()) : std::atan2(sine, rotation.w());
  return 2 * half / sine * rotation.vec();
}

/// The cross product matrix: CrossProductMatrix(a) * b = a x b.
inline Eigen::Matrix3d CrossProductMatrix(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

}  // namespace victorious
