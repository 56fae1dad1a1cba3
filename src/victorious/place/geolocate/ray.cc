#include "victorious/place/geolocate/ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kMinDistanceM = 1;  // minimum distance of an object; points behind the camera have negative distance

double Square(double value) { return value * value; }

void SetDirection(const LineOfSight& line, const TangentPlane& plane, Ray& ray) {
  const double sin_azimuth = std::sin(line.azimuth_rad);
  const double cos_azimuth = std::cos(line.azimuth_rad);
  const double sin_elevation = std::sin(line.elevation_rad);
  ray.cos_elevation = std::cos(line.elevation_rad);
  const Eigen::Quaterniond plane_from_local = plane.LocalEnuFromEnu(ray.camera).conjugate();
  ray.forward = plane_from_local *
                Eigen::Vector3d(sin_azimuth * ray.cos_elevation, cos_azimuth * ray.cos_elevation, sin_elevation);
  ray.side = plane_from_local * Eigen::Vector3d(cos_azimuth, -sin_azimuth, 0);
  ray.rise =
      plane_from_local * Eigen::Vector3d(-sin_azimuth * sin_elevation, -cos_azimuth * sin_elevation, ray.cos_elevation);
}

// Uses the line's range if it has one, else the distance to its intersection with the ground.
void SetRange(const LineOfSight& line, const TangentPlane& plane, const LocateOptions& options, Ray& ray) {
  if (line.range_m) {
    ray.range_source = RangeSource::kMeasured;
    ray.range_m = *line.range_m;
    if (!line.sigma_range_m) ray.range_fraction = options.line.range_fraction;
    ray.sigma_range_m = line.sigma_range_m.value_or(options.line.range_fraction * ray.range_m);
    return;
  }
  if (!options.ground) return;
  const double height_sigma_m = std::hypot(options.ground_sigma_m, options.line.position_m, options.common.height_m);
  const auto patch =
      IntersectGround(*options.ground, plane, ray.camera, ray.forward, options.gate_sigma * height_sigma_m);
  if (!patch) {
    ray.ground_miss = patch.error();
    return;
  }
  const double range_m = (patch->point - ray.camera).dot(ray.forward);
  if (range_m <= kMinDistanceM) {
    ray.ground_miss = GroundMiss::kBelow;
    return;
  }
  ray.range_source = RangeSource::kGround;
  ray.range_m = range_m;
  ray.normal = patch->normal;
  const double cos_incidence = -ray.forward.dot(ray.normal);
  ray.range_per_height = (plane.LocalEnuFromEnu(patch->point) * ray.normal).z() / cos_incidence;
  const double angular_m = range_m * ray.sigma_rad * std::hypot(ray.rise.dot(ray.normal), ray.side.dot(ray.normal));
  ray.sigma_range_m = std::hypot(options.ground_sigma_m * ray.range_per_height,
                                 std::hypot(options.line.position_m, angular_m) / cos_incidence);
}

// `least-squares` ignores ranges, except for a single line, which is placed by its range as in `prior`.
double RangeWeight(const Ray& ray, const LocateOptions& options, bool is_single) {
  if (ray.range_source == RangeSource::kNone) return 0;
  if (is_single || options.method == LocateMethod::kGround) return 1;
  if (options.method == LocateMethod::kLeastSquares) return 0;
  const double across_m2 = Square(options.line.position_m) + Square(ray.sigma_rad * ray.range_m);
  return std::min(1.0, across_m2 / Square(ray.sigma_range_m));
}

Frustum MakeFrustum(const Ray& ray, const LocateOptions& options) {
  const double common_rad2 = Square(RadiansFromDegrees(options.common.heading_deg)) +
                             Square(RadiansFromDegrees(options.common.boresight_side_deg)) +
                             Square(RadiansFromDegrees(options.common.boresight_rise_deg));
  Frustum frustum;
  const double gate2 = Square(options.gate_sigma);
  frustum.base_m2 = Square(options.identity_radius_m) + gate2 * Square(options.line.position_m);
  frustum.slope = gate2 * (Square(ray.sigma_rad) + common_rad2 / 2);  // two axes: half of the variance each
  frustum.nearest_m = kMinDistanceM;
  frustum.farthest_m = std::numeric_limits<double>::infinity();
  if (ray.range_source == RangeSource::kMeasured) {
    const double allowance =
        std::max(options.distance_prior_allowance, 1 + options.gate_sigma * ray.sigma_range_m / ray.range_m);
    frustum.nearest_m = std::max(kMinDistanceM, ray.range_m / allowance);
    frustum.farthest_m = std::max(frustum.nearest_m, ray.range_m * allowance);
  }
  return frustum;
}

double MeasuredWeight(const Ray& ray, double distance_m, double sigma_position_m) {
  const double shift_m2 = Square(sigma_position_m);
  return shift_m2 / (shift_m2 + Square(distance_m * ray.sigma_rad));
}

}  // namespace

std::vector<Ray> MakeRays(std::span<const LineOfSight> lines, const TangentPlane& plane, const LocateOptions& options) {
  double last_s = -std::numeric_limits<double>::infinity();
  for (const LineOfSight& line : lines) last_s = std::max(last_s, line.time_s);
  std::vector<Ray> rays;
  rays.reserve(lines.size());
  for (const LineOfSight& line : lines) {
    Ray ray;
    ray.time_s = line.time_s - last_s;
    ray.camera = plane.EnuFromGeodetic(line.camera);
    ray.sigma_rad = line.sigma_rad.value_or(RadiansFromDegrees(options.line.angle_deg));
    SetDirection(line, plane, ray);
    SetRange(line, plane, options, ray);
    ray.range_weight = RangeWeight(ray, options, lines.size() == 1);
    ray.frustum = MakeFrustum(ray, options);
    rays.push_back(ray);
  }
  return rays;
}

Eigen::Vector3d MaxLikelihoodDirection(const Ray& ray, const Eigen::Vector3d& measured,
                                       const Eigen::Vector3d& to_object, double sigma_position_m) {
  const double distance_m = std::max(kMinDistanceM, to_object.norm());
  const double measured_weight = MeasuredWeight(ray, distance_m, sigma_position_m);
  return (measured_weight * measured + (1 - measured_weight) * to_object / distance_m).normalized();
}

double DirectionVariance(const Ray& ray, double distance_m, double sigma_position_m) {
  return MeasuredWeight(ray, distance_m, sigma_position_m) * Square(ray.sigma_rad);
}

double NoiseBiasFactor(std::ptrdiff_t count) {
  constexpr double kSigmas = 3;  // the mean of 2 n squared residuals has a standard deviation of 1 / sqrt(n)
  return 2 * (1 + kSigmas / std::sqrt(static_cast<double>(std::max<std::ptrdiff_t>(1, count))));
}

bool InFrustum(const Ray& ray, const Motion& motion) {
  const Eigen::Vector3d to_object = motion.At(ray.time_s) - ray.camera;
  const double along = to_object.dot(ray.forward);
  if (along < ray.frustum.nearest_m || along > ray.frustum.farthest_m) return false;
  return to_object.squaredNorm() - along * along <= ray.frustum.base_m2 + along * along * ray.frustum.slope;
}

}  // namespace victorious
