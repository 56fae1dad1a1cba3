// Lens distortion, OpenCV's model (Brown 1966). In normalised image coordinates x = X / Z, y = Y / Z, r2 = x^2 + y^2:
//   x' = x (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y (1 + k1 r2 + k2 r2^2 + k3 r2^3) + p1 (r2 + 2 y^2) + 2 p2 x y
#pragma once

#include <array>

#include <Eigen/Core>

namespace victorious {

/// k1, k2, p1, p2, k3.
using LensDistortion = std::array<double, 5>;

/// Maps an ideal (pinhole) point to the distorted point, both in normalised coordinates.
Eigen::Vector2d Distort(const Eigen::Vector2d& point, const LensDistortion& lens);

/// The inverse of Distort, by fixed-point iteration: exact to 1e-9 if the distortion is smaller than the image's width.
/// Returns its argument if the iteration diverges.
Eigen::Vector2d Undistort(const Eigen::Vector2d& distorted, const LensDistortion& lens);

}  // namespace victorious
