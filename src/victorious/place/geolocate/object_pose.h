// Estimates the pose (6 degrees of freedom) of an object relative to the camera from 3D-2D point correspondences: PnP
// with priors. Called by place/observe/object_pose.cc with the inlier matches of a CAD model's view.
//
// Minimises over rotation R and translation t, starting from the direction of the matched view,
//   sum_i w_i |project(R p_i + t) - seen_i|^2 / sigma^2 + |rotation across the line of sight|^2 / sigma_view^2
//     + |tilt against the vertical|^2 / sigma_up^2
// by the Levenberg-Marquardt method. The priors keep the rotation near that of the matched view, within the spacing of
// the view grid, and the object upright where the vertical is known: few or nearly coplanar points alone leave the tilt
// undetermined. The weights w_i are MLESAC's posterior inlier probabilities (geometry/robust/mlesac.h) under the best
// of the poses from samples of three points, so that outliers have no influence.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/geometry/rigid3.h"

namespace victorious {

/// A 3D point of the object and its observation in normalised image coordinates (depth 1), x right and y down, lens
/// distortion removed.
struct PointObservation {
  Eigen::Vector3d point;  ///< m, in the object's frame: origin at its centre, x to its front, z up
  Eigen::Vector2d seen;   ///< X / Z, Y / Z
};

struct ObjectPoseFitOptions {
  double sigma = 1e-3;          ///< of an observed point in normalised coordinates, along each axis
  double sigma_view_rad = 0.1;  ///< of the direction of the matched view: width of the rotation prior
  std::optional<Eigen::Vector3d> up_in_camera = {};  ///< unit vector of the vertical, where it is known
  double sigma_up_rad = 0.1;                         ///< of the object's up axis against the vertical, about each axis
  int hypotheses = 100;  ///< maximum number of MLESAC hypotheses; 0: start from the view's rotation alone
  std::uint64_t seed = 1;
};

struct ObjectPoseFit {
  Rigid3 camera_from_object;
  double sigma_angle_rad = 0;  ///< of the direction to the origin, about each axis
  double sigma_range_m = 0;    ///< of the distance to the origin
  /// of the direction from the object to the camera, in the object's frame, about each axis
  double sigma_view_rad = 0;
};

/// Estimates the pose with its standard deviations.
/// @param camera_from_object  initial rotation: that of the matched view, with the in-plane rotation of the match
/// @return std::nullopt for fewer than three points, or if no pose in front of the camera fits. Deterministic.
std::optional<ObjectPoseFit> FitObjectPose(std::span<const PointObservation> points,
                                           const Eigen::Quaterniond& camera_from_object,
                                           const ObjectPoseFitOptions& options);

}  // namespace victorious
