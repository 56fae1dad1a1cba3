// The most likely place: all inlier rays and ranges with their own errors, and the flight's common errors as unknowns.
//
// Unknowns: o, v, and c, the common errors in units of their sigmas. Minimises
//   |c|^2 + sum_i rho(|q_i(o + v t_i, c)|^2 / s_i^2) + rho((range_i - |..|)^2 / sigma_range_i^2) + ground
// with q_i the object's offset from the ray (turned and moved by the common errors) at its distance d_i, along two axes
// across the ray; s_i^2 = (d_i sigma_i)^2 + sigma_position^2; rho Huber's loss. Distances, axes and inliers are chosen
// anew between rounds. The covariance is the inverse of J'J at the minimum, widened by the common errors that lines
// alone cannot tell from the place and that therefore are not estimated: it does not shrink below what these leave
// open.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/geolocate/locate_options.h"
#include "victorious/geolocate/ray.h"

namespace victorious {

struct RefinedPlace {
  Motion motion;
  Eigen::MatrixXd covariance;  ///< of the place, then the velocity where there is one: 3 x 3 or 6 x 6
  std::vector<bool> inliers;   ///< by the angles that are left when the common errors are taken off
};

/// Refines `start`, choosing the inliers anew between rounds. Nothing where the rays leave the place open.
/// @param plane  that the rays are in
std::optional<RefinedPlace> RefinePlace(std::span<const Ray> rays, const Motion& start, std::vector<bool> inliers,
                                        const TangentPlane& plane, const LocateOptions& options);

}  // namespace victorious
