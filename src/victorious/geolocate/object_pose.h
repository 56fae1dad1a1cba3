// How an object stands before the camera, from points of it that are seen: its six degrees of freedom.
//
// Minimises over rotation R and translation t, from the direction of the view that matched,
//   sum_i rho(|project(R p_i + t) - seen_i|^2 / sigma^2) + |turn across the line of sight|^2 / sigma_view^2
// with rho Cauchy's loss, by Levenberg and Marquardt's method. The prior holds the object to the view that matched, up
// to what the views' grid leaves open, where the points alone (few, or nearly in one plane) would let it tilt.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/geometry/rigid3.h"

namespace victorious {

/// A point of the object and where it is seen: at depth 1 before the camera, right and down, lens undone.
struct SeenPoint {
  Eigen::Vector3d point;  ///< m, the origin in the middle of the object
  Eigen::Vector2d seen;   ///< X / Z, Y / Z
};

struct ObjectPoseOptions {
  double sigma = 1e-3;          ///< of a point's place at depth 1, along each axis
  double sigma_view_rad = 0.1;  ///< of the direction of the view that matched
};

struct ObjectPose {
  Rigid3 camera_from_object;
  double sigma_angle_rad = 0;  ///< of the direction to the origin, each axis
  double sigma_range_m = 0;    ///< of the distance to it
};

/// @param camera_from_object  the rotation to start from: of the view that matched, turned as in the picture
/// Nothing for fewer than three points, or where they do not fit before the camera.
std::optional<ObjectPose> FitObjectPose(std::span<const SeenPoint> points, const Eigen::Quaterniond& camera_from_object,
                                        const ObjectPoseOptions& options);

}  // namespace victorious
