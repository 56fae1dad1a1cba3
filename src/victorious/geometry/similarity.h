// Similarity transformations of the plane: scale, rotation, translation (RST transform; thesis, section 3.3.3).
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"

namespace victorious {

/// target = scale * R(rotation) * source + translation. Rotation turns +x towards +y (down in an image: clockwise).
/// Variables are named target_from_source, so that products chain.
struct Similarity2 {
  double scale = 1.0;         ///< > 0
  double rotation_rad = 0.0;  ///< in [-pi, pi]
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();

  [[nodiscard]] Eigen::Matrix2d Linear() const {
    const double c = scale * std::cos(rotation_rad);
    const double s = scale * std::sin(rotation_rad);
    return (Eigen::Matrix2d() << c, -s, s, c).finished();
  }
  [[nodiscard]] Eigen::Vector2d Apply(const Eigen::Vector2d& point) const { return Linear() * point + translation; }

  [[nodiscard]] Similarity2 Inverse() const {
    Similarity2 inverse{1.0 / scale, -rotation_rad, Eigen::Vector2d::Zero()};
    inverse.translation = -(inverse.Linear() * translation);
    return inverse;
  }

  /// The transformation by `other`, then by this one.
  [[nodiscard]] Similarity2 operator*(const Similarity2& other) const {
    return {scale * other.scale, WrapAngle(rotation_rad + other.rotation_rad), Apply(other.translation)};
  }

  [[nodiscard]] Eigen::Matrix3d Matrix() const {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    matrix.topLeftCorner<2, 2>() = Linear();
    matrix.topRightCorner<2, 1>() = translation;
    return matrix;
  }
};

}  // namespace victorious
