// Lens distortion in OpenCV's model (Brown 1966): where a lens shows what a pinhole would show elsewhere. In the plane
// at depth 1, x = X / Z, y = Y / Z, r2 = x^2 + y^2:
//   x' = x (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y (1 + k1 r2 + k2 r2^2 + k3 r2^3) + p1 (r2 + 2 y^2) + 2 p2 x y
#pragma once

#include <array>

#include <Eigen/Core>

namespace victorious {

/// k1, k2, p1, p2, k3.
using LensDistortion = std::array<double, 5>;

/// From where a pinhole shows a point to where the lens shows it, both at depth 1.
Eigen::Vector2d Distort(const Eigen::Vector2d& point, const LensDistortion& lens);

/// The way back, by fixed-point iteration: exact to 1e-9 where the lens bends by less than its picture is wide.
Eigen::Vector2d Undistort(const Eigen::Vector2d& shown, const LensDistortion& lens);

}  // namespace victorious
