// Applies homographies to points and polygons of the plane.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/polygon.h"

namespace victorious {

/// The image of `point` under a 3x3 homography (target_from_source). Not finite for points on the horizon.
inline Eigen::Vector2d ApplyHomography(const Eigen::Matrix3d& homography, const Eigen::Vector2d& point) {
  return (homography * point.homogeneous()).hnormalized();
}

/// Maps each corner.
inline Polygon ProjectPolygon(const Eigen::Matrix3d& homography, const Polygon& polygon) {
  Polygon projected;
  projected.reserve(polygon.size());
  for (const Eigen::Vector2d& corner : polygon) projected.push_back(ApplyHomography(homography, corner));
  return projected;
}

}  // namespace victorious
