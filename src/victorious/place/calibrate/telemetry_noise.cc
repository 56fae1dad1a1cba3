#include "victorious/place/calibrate/telemetry_noise.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {

using Eigen::Vector3d;

TelemetryNoise EstimateNoise(const CameraTrajectory& cameras) {
  const std::vector<CameraState>& states = cameras.states();
  const TangentPlane plane(states.front().place);
  std::vector<double> turns_rad;
  std::vector<double> shifts_m;
  for (std::size_t i = 1; i + 1 < states.size(); ++i) {
    const CameraState& before = states[i - 1];
    const CameraState& after = states[i + 1];
    const double along = (states[i].time_s - before.time_s) / (after.time_s - before.time_s);
    const double noise_scale = std::sqrt(1 + along * along + (1 - along) * (1 - along));
    const Vector3d start = plane.EnuFromGeodetic(before.place);
    const Vector3d shift =
        plane.EnuFromGeodetic(states[i].place) - start - along * (plane.EnuFromGeodetic(after.place) - start);
    for (const double one : shift) shifts_m.push_back(std::abs(one) / noise_scale);
    if (!before.attitude || !states[i].attitude || !after.attitude) continue;
    const Eigen::Quaterniond between = CameraFromEnu(*before.attitude).slerp(along, CameraFromEnu(*after.attitude));
    const Eigen::AngleAxisd turn(CameraFromEnu(*states[i].attitude) * between.conjugate());
    for (const double axis : turn.axis()) turns_rad.push_back(std::abs(WrapAngle(turn.angle()) * axis) / noise_scale);
  }
  if (turns_rad.empty()) return {};
  return {.attitude_rad = kMadToSigma * Median(std::move(turns_rad)),
          .place_m = kMadToSigma * Median(std::move(shifts_m))};
}

}  // namespace victorious
