// Lines of sight in one tangent plane, with the quantities that the estimators need precomputed: directions, range,
// weights and conic frustum.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/place/geolocate/locate_options.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

enum class RangeSource { kNone, kMeasured, kGround };

/// The conic frustum of uncertainty (thesis, section 4.3.3): at distance a along the ray, a point of the object may lie
/// up to sqrt(base_m2 + a^2 slope) from the ray. nearest_m and farthest_m bound a.
struct Frustum {
  double base_m2 = 0;
  double slope = 0;
  double nearest_m = 0;
  double farthest_m = 0;
};

/// One line of sight in the plane's axes. forward, side and rise are orthonormal: along the line, to its right, and
/// upwards perpendicular to both, so that errors in azimuth and elevation rotate the ray towards side and rise.
struct Ray {
  double time_s = 0;  ///< relative to the last line: at most 0
  Eigen::Vector3d camera;
  Eigen::Vector3d forward;
  Eigen::Vector3d side;
  Eigen::Vector3d rise;
  double cos_elevation = 1;  ///< derivative of the direction, towards side, by the heading error
  double sigma_rad = 0;
  RangeSource range_source = RangeSource::kNone;
  double range_m = 0;
  double sigma_range_m = 0;
  double range_fraction = 0;    ///< sigma relative to the true range, if only a relative error is given; else 0
  Eigen::Vector3d normal;       ///< of the ground at the end of the ray, if the range is from the ground
  double range_per_height = 0;  ///< derivative of the range by the ground's height there, m/m
  std::optional<GroundMiss> ground_miss;  ///< why the ray does not intersect the given ground
  double range_weight = 0;  ///< of the range in the linear systems, relative to 1 for each direction across the ray
  Frustum frustum;
};

/// Linear motion of the object in the plane: its place at time 0 and its velocity.
struct Motion {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s

  [[nodiscard]] Eigen::Vector3d At(double time_s) const { return place + time_s * velocity; }
};

/// Returns one ray per line, in `plane`, which must be the tangent plane at the first line's camera. `options.method`
/// determines the weight of the ranges.
std::vector<Ray> MakeRays(std::span<const LineOfSight> lines, const TangentPlane& plane, const LocateOptions& options);

/// True if the object lies in the ray's frustum at the time of the ray.
bool InFrustum(const Ray& ray, const Motion& motion);

/// The maximum-likelihood estimate of the true direction from the camera to the object: a weighted mean of the measured
/// direction and of the direction to the estimated place, closer to the more accurate one. Offsets measured
/// perpendicular to it are uncorrelated with the ray's own error. Offsets perpendicular to either input direction are
/// correlated with it, which biases the estimated place along the rays, strongly so if the rays determine the distance
/// poorly.
/// @param measured          direction of the ray, corrected for the common errors where these are estimated
/// @param to_object         from the measured camera position to the estimated place, m
/// @param sigma_position_m  of the camera position, each axis
Eigen::Vector3d MaxLikelihoodDirection(const Ray& ray, const Eigen::Vector3d& measured,
                                       const Eigen::Vector3d& to_object, double sigma_position_m);

/// The variance of MaxLikelihoodDirection, rad^2 along each axis. Parallel rays appear to differ in direction by this
/// amount, which simulates a baseline: the information about the distance is the squared sine of the angle between
/// rays.
double DirectionVariance(const Ray& ray, double distance_m, double sigma_position_m);

/// The factor for the variances of `count` rays when they are subtracted from the information (see DirectionVariance);
/// it includes a margin of three sigmas for their sampling error.
double NoiseBiasFactor(std::ptrdiff_t count);

}  // namespace victorious
