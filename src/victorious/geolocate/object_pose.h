// How an object stands before the camera, from points of it that are seen: its six degrees of freedom.
//
// Minimises over rotation R and translation t, from the direction of the view that matched,
//   sum_i w_i |project(R p_i + t) - seen_i|^2 / sigma^2 + |turn across the line of sight|^2 / sigma_view^2
//     + |tilt against the vertical|^2 / sigma_up^2
// by Levenberg and Marquardt's method. The priors hold the object to the view that matched, up to what the views' grid
// leaves open, and upright where the vertical is known: the points alone (few, or nearly in one plane) would let it
// tilt. The weights are MLESAC's (geometry/robust/mlesac.h): how likely each point is to agree with the best of the
// poses that samples of three give. Points that matched by chance do not pull.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/geometry/rigid3.h"

namespace victorious {

/// A point of the object and where it is seen: at depth 1 before the camera, right and down, lens undone.
struct SeenPoint {
  Eigen::Vector3d point;  ///< m, the origin in the middle of the object; x to its front, z up
  Eigen::Vector2d seen;   ///< X / Z, Y / Z
};

struct ObjectPoseOptions {
  double sigma = 1e-3;                               ///< of a point's place at depth 1, along each axis
  double sigma_view_rad = 0.1;                       ///< of the direction of the view that matched
  std::optional<Eigen::Vector3d> up_in_camera = {};  ///< the vertical, of length 1, where it is known
  double sigma_up_rad = 0.1;                         ///< how far the object's up leans from it, about each axis
  int hypotheses = 100;                              ///< MLESAC's, at most; 0: from the view's rotation alone
  std::uint64_t seed = 1;
};

struct ObjectPose {
  Rigid3 camera_from_object;
  double sigma_angle_rad = 0;  ///< of the direction to the origin, each axis
  double sigma_range_m = 0;    ///< of the distance to it
  double sigma_view_rad = 0;   ///< of the direction from the object to the camera, in its own frame, each axis
};

/// @param camera_from_object  the rotation to start from: of the view that matched, turned as in the picture
/// Nothing for fewer than three points, or where they do not fit before the camera. Deterministic.
std::optional<ObjectPose> FitObjectPose(std::span<const SeenPoint> points, const Eigen::Quaterniond& camera_from_object,
                                        const ObjectPoseOptions& options);

}  // namespace victorious
