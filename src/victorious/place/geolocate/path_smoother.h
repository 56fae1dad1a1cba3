// Kalman filter and fixed-interval smoother (Rauch, Tung and Striebel 1965) of an object's path from rays with measured
// ranges. Used by motion_path.cc.
//
// State: place p, velocity v, the errors common to the flight c in units of their sigmas, and the error of the ground's
// height. Between rays  p += v dt,  and v changes by white noise of spectral density q, m^2/s^3; c is constant. Each
// ray gives three rows, linear at the object's distance d,
//   side . (p - camera - c_position)    = d (c_heading cos(elevation) + c_side) + noise
//   rise . (p - camera - c_position)    = d c_rise + noise
//   forward . (p - camera - c_position) = range + d c_range + noise
// and a given ground a fourth:  normal . (p - patch) = c_ground + noise.
//
// q varies along the path: an object drives straight, but for turns, starts and stops. It is estimated from the
// smoothed changes of velocity within half a second, by MacKay's fixed point (Neural Computation 4, 1992)
//   q = (prior + sum |dv|^2 / dt) / (prior + sum gamma),  gamma = 1 - var(dv) / (q dt),
// so that a straight path is smoothed over its whole length and a corner is not cut. Rows are weighted by Huber's loss,
// and lines beyond the gate are rejected.
//
// c has no noise: smoothed, it is that of the next ray. The smoother's gain therefore has rows of p and v only.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/place/geolocate/linear_place.h"
#include "victorious/place/geolocate/locate_options.h"
#include "victorious/place/geolocate/ray.h"

namespace victorious {

/// Place, velocity, common errors (linear_place.h), error of the ground: the last two in sigmas.
inline constexpr int kPathUnknowns = 6 + kNumCommonErrors + 1;
using PathVector = Eigen::Matrix<double, kPathUnknowns, 1>;
using PathMatrix = Eigen::Matrix<double, kPathUnknowns, kPathUnknowns>;

/// What is known of an object's motion beforehand.
struct PathModel {
  double speed_sigma_m_s = 0;      ///< of the velocity along each horizontal axis
  double climb_sigma_m_s = 0;      ///< of the vertical velocity
  double vertical_density = 0;     ///< of the vertical acceleration, m^2/s^3
  bool manoeuvres = false;         ///< the horizontal velocity may change
  const Ground* ground = nullptr;  ///< on which the object moves, or null
  double ground_sigma_m = 0;       ///< of the ground's height
};

/// An object that does not move.
[[nodiscard]] PathModel StaticPath();

/// Residuals of one ray from the smoothed path, in sigmas of the ray's own errors.
struct PathResidual {
  double side = 0;
  double rise = 0;
  double range = 0;
};

struct PathFit {
  std::vector<PathVector> means;        ///< smoothed, one per ray
  std::vector<PathMatrix> covariances;  ///< of `means`, with the noise factors applied
  std::vector<PathResidual> residuals;  ///< one per ray
  double angle_factor = 1;              ///< scatter across the rays over their sigmas, at least 1
  double range_factor = 1;              ///< scatter of the ranges over their sigmas, 1 to 3
  double manoeuvre_unknowns = 0;        ///< effective number of unknowns that the changes of velocity use
};

/// Fits the path. Cost: some 0.1 ms per ray with manoeuvres, 0.03 ms without.
/// @param rays  in order of time, each with a measured range; not empty
PathFit FitPath(std::span<const Ray> rays, const TangentPlane& plane, const PathModel& model,
                const LocateOptions& options);

}  // namespace victorious
