// calibrate/: the motion of the image between two frames as an affine map. Unlike a similarity it contains
// the shear of ground that is seen obliquely: what is nearer moves faster.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// shift(x) = centre_px + gradient (x - middle of the image).
struct ImageFlow {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d gradient = Eigen::Matrix2d::Zero();
};

/// Fits by iteratively reweighted least squares with a redescending (Cauchy) weight, about the median residual: corners
/// on what moves, or stands high above the ground, do not count. std::nullopt with fewer than 20 corners, or if these
/// lie on a line.
[[nodiscard]] std::optional<ImageFlow> FitImageFlow(std::span<const PointPair> corners, const cv::Size& image);

}  // namespace victorious
