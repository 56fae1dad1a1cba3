// Rigid transformations of space: rotation and translation, no scale.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious {

/// point_in_target = rotation * point_in_source + translation. Variables are named target_from_source, so that products
/// chain: camera_from_model = camera_from_world * world_from_model.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit quaternion
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< the source's origin, in the target frame

  [[nodiscard]] Eigen::Vector3d Apply(const Eigen::Vector3d& point) const { return rotation * point + translation; }

  [[nodiscard]] Rigid3 Inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {back, -(back * translation)};
  }

  [[nodiscard]] Eigen::Matrix4d Matrix() const {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
    matrix.topRightCorner<3, 1>() = translation;
    return matrix;
  }
};

/// Composition: applies `b` first, then `a`.
inline Rigid3 operator*(const Rigid3& a, const Rigid3& b) {
  return {(a.rotation * b.rotation).normalized(), a.Apply(b.translation)};
}

}  // namespace victorious
