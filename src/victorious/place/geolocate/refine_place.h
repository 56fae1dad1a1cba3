// Maximum-likelihood refinement of the object's place (method `ml`): all inlier rays and ranges with their own errors,
// and the errors common to the flight as unknowns with priors. Solved with Ceres.
//
// Unknowns: place o, velocity v, and the common errors c in units of their sigmas. Minimises
//   |c|^2 + sum_i rho(|q_i(o + v t_i, c)|^2 / s_i^2) + rho((range_i - |..|)^2 / sigma_range_i^2) + ground
// where q_i is the object's offset from the ray (rotated and translated by the common errors) at its distance d_i,
// along two axes perpendicular to the ray; s_i^2 = (d_i sigma_i)^2 + sigma_position^2; rho is Huber's loss. Distances,
// axes and inliers are recomputed between rounds. The covariance is the inverse of J'J at the minimum, inflated by
// those common errors that the lines alone cannot separate from the place and that are therefore not estimated.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/place/geolocate/locate_options.h"
#include "victorious/place/geolocate/ray.h"

namespace victorious {

struct RefinedPlace {
  Motion motion;
  Eigen::MatrixXd covariance;  ///< of the place, followed by the velocity if it is estimated: 3 x 3 or 6 x 6
  std::vector<bool> inliers;   ///< by the angular residuals after correction of the common errors; one per ray
};

/// Refines `start` and selects the inliers anew between rounds. Returns std::nullopt if the rays do not determine the
/// place.
/// @param plane  of the rays
std::optional<RefinedPlace> RefinePlace(std::span<const Ray> rays, const Motion& start, std::vector<bool> inliers,
                                        const TangentPlane& plane, const LocateOptions& options);

}  // namespace victorious
