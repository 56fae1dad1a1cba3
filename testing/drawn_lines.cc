#include "testing/drawn_lines.h"

#include <cmath>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious::testing {
namespace {

using Eigen::Vector3d;

Vector3d NormalVector(Random& random) {
  const double x = random.Normal();
  const double y = random.Normal();
  return {x, y, random.Normal()};
}

// The line from a camera to a point, both in the tangent plane; its angles refer to the camera's own tangent plane.
LineOfSight MakeLineOfSight(const TangentPlane& plane, const Vector3d& camera, const Vector3d& point) {
  const Vector3d seen = plane.LocalEnuFromEnu(camera) * (point - camera);
  return {.camera = plane.GeodeticFromEnu(camera),
          .azimuth_rad = std::atan2(seen.x(), seen.y()),
          .elevation_rad = std::atan2(seen.z(), std::hypot(seen.x(), seen.y())),
          .range_m = seen.norm()};
}

}  // namespace

SyntheticLines SimulateLinesOfSight(const SyntheticLinesOptions& options) {
  Random random(options.seed);
  SyntheticLines drawn;
  drawn.object = {RadiansFromDegrees(42.36), RadiansFromDegrees(-71.09), 5};
  const TangentPlane plane(drawn.object);
  const Vector3d position_bias = options.bias_position_m * NormalVector(random);
  const double azimuth_bias_deg = options.bias_deg * random.Normal();
  const double elevation_bias_deg = options.bias_deg * random.Normal();
  const double first_rad = random.Uniform(0, 2 * kPi);
  for (int i = 0; i < options.count; ++i) {
    const double done = options.count > 1 ? static_cast<double>(i) / (options.count - 1) : 1;
    const double angle = first_rad + done * RadiansFromDegrees(options.arc_deg);
    const Vector3d camera(options.distance_m * std::cos(angle), options.distance_m * std::sin(angle), options.height_m);
    LineOfSight line = MakeLineOfSight(plane, camera, (done - 1) * options.duration_s * options.velocity_enu);
    const double distance_m = *line.range_m;
    line.time_s = done * options.duration_s;
    line.camera = plane.GeodeticFromEnu(camera + position_bias + options.noise_position_m * NormalVector(random));
    line.azimuth_rad += RadiansFromDegrees(azimuth_bias_deg + options.noise_deg * random.Normal());
    line.elevation_rad += RadiansFromDegrees(elevation_bias_deg + options.noise_deg * random.Normal());
    const bool wrong = random.Uniform() < options.outlier_fraction;
    if (wrong) {
      constexpr double kFurthestDeg = 15;
      line.azimuth_rad += RadiansFromDegrees(random.Uniform(-kFurthestDeg, kFurthestDeg));
      line.elevation_rad += RadiansFromDegrees(random.Uniform(-kFurthestDeg, kFurthestDeg));
    }
    line.range_m.reset();
    if (options.range_fraction > 0) {
      line.range_m = distance_m * std::exp(options.range_fraction * random.Normal());
      line.sigma_range_m = options.range_fraction * distance_m;
    }
    if (options.noise_deg > 0) line.sigma_rad = RadiansFromDegrees(options.noise_deg);
    drawn.lines.push_back(line);
    drawn.wrong.push_back(wrong);
  }
  return drawn;
}

}  // namespace victorious::testing
