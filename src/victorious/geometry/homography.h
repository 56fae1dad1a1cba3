// Projective maps of the plane.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/polygon.h"

namespace victorious {

/// The image of `point` under a 3x3 homography (target_from_source). Points on the horizon come out as infinities.
inline Eigen::Vector2d ApplyHomography(const Eigen::Matrix3d& homography, const Eigen::Vector2d& point) {
  return (homography * point.homogeneous()).hnormalized();
}

/// The corners' images.
inline Polygon ProjectPolygon(const Eigen::Matrix3d& homography, const Polygon& polygon) {
  Polygon projected;
  projected.reserve(polygon.size());
  for (const Eigen::Vector2d& corner : polygon) projected.push_back(ApplyHomography(homography, corner));
  return projected;
}

}  // namespace victorious
