// Lines of sight in one tangent plane, with everything that the estimators ask of them worked out once.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/geolocate/locate_options.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

enum class RangeSource { kNone, kMeasured, kGround };

/// The conic frustum of uncertainty: at distance a along the ray a point may lie sqrt(base_m2 + a^2 slope) off it.
struct Frustum {
  double base_m2 = 0;
  double slope = 0;
  double nearest_m = 0;
  double farthest_m = 0;
};

/// One line in the plane's axes. forward, side, rise are unit vectors: along the line, to its right, and across both
/// upwards, so that errors in azimuth and elevation are turns towards side and rise.
struct Ray {
  double time_s = 0;  ///< after the last line's: at most 0
  Eigen::Vector3d camera;
  Eigen::Vector3d forward;
  Eigen::Vector3d side;
  Eigen::Vector3d rise;
  double cos_elevation = 1;  ///< what a heading error does to the direction
  double sigma_rad = 0;
  RangeSource range_source = RangeSource::kNone;
  double range_m = 0;
  double sigma_range_m = 0;
  double range_share = 0;             ///< sigma over the true range, where that is all that is known of it; else 0
  Eigen::Vector3d normal;             ///< of the ground where the range ends, if that is from the ground
  double ground_share = 0;            ///< by how much the range changes with the ground's height there, m/m
  std::optional<NoGround> no_ground;  ///< why there is no range from a ground that was told
  double range_weight = 0;  ///< of the range in the linear systems, beside 1 for each direction across the ray
  Frustum frustum;
};

/// Where an object is at time 0 and how it moves, in the plane.
struct Motion {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s

  [[nodiscard]] Eigen::Vector3d At(double time_s) const { return place + time_s * velocity; }
};

/// One ray a line, in the plane at the first line's camera, which is `plane`. `options.method` decides how much the
/// ranges count.
std::vector<Ray> MakeRays(std::span<const LineOfSight> lines, const TangentPlane& plane, const LocateOptions& options);

/// Whether the object is in the ray's frustum when it was seen.
bool InFrustum(const Ray& ray, const Motion& motion);

/// The most likely true direction from a camera to a place: between the ray as `told` (without common errors, if these
/// are known) and `seen`, the place from the camera as told, nearer to the one that errs less. Across that direction, a
/// ray's own error and the axes that it is measured along are uncorrelated. Across either of the two they are not,
/// which draws the place along the rays, and far where these leave it loose.
Eigen::Vector3d LikelyDirection(const Ray& ray, const Eigen::Vector3d& told, const Eigen::Vector3d& seen,
                                double sigma_position_m);

/// The variance of that direction, rad^2 along each axis. So much parallel rays seem to differ, which feigns a
/// baseline: the squared sine of the angle between rays is what tells the distance.
double LikelyVariance(const Ray& ray, double distance_m, double sigma_position_m);

/// What the variances that `count` rays feign are to be taken times, so that their scatter feigns nothing either.
double FeignedFactor(std::ptrdiff_t count);

}  // namespace victorious
