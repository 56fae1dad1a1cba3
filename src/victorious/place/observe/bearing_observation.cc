#include "victorious/place/observe/bearing_observation.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Clockwise from north, [0, 2 pi); std::nullopt for a near-vertical direction.
std::optional<double> HorizontalAzimuth(const Vector3d& direction_enu) {
  constexpr double kMinHorizontal = 0.1;
  if (direction_enu.head<2>().norm() < kMinHorizontal) return std::nullopt;
  const double bearing = std::atan2(direction_enu.x(), direction_enu.y());
  return bearing < 0 ? bearing + 2 * kPi : bearing;
}

// @param direction  of the line, a unit vector
ClockShift ShiftOfLine(const ClockError& error, const Vector3d& direction) {
  const Vector3d change = error.turned_enu_rad.cross(direction);
  const double level2 = std::max(1e-6, direction.head<2>().squaredNorm());
  return {.camera_enu_m = error.moved_enu_m,
          .azimuth_rad = (direction.y() * change.x() - direction.x() * change.y()) / level2,
          .elevation_rad = change.z() / std::sqrt(level2)};
}

// The line's component across the optical axis is inversely proportional to the focal length.
// @param direction, axis  unit vectors
FocalShift ShiftOfLine(double sigma_focal, const Vector3d& direction, const Vector3d& axis) {
  const Vector3d across = direction - direction.dot(axis) * axis;
  const Vector3d change = -sigma_focal * (across - direction.dot(across) * direction);
  const double level2 = std::max(1e-6, direction.head<2>().squaredNorm());
  return {.sigma = sigma_focal,
          .azimuth_rad = (direction.y() * change.x() - direction.x() * change.y()) / level2,
          .elevation_rad = change.z() / std::sqrt(level2)};
}

}  // namespace

std::optional<BearingObservation> MakeBearingObservation(const ObjectPose& object_pose, const CameraState& camera) {
  if (!camera.IsComplete()) return std::nullopt;
  const Quaterniond enu_from_camera = CameraFromEnu(*camera.attitude).conjugate();
  const Vector3d direction = enu_from_camera * object_pose.direction;
  BearingObservation observation{.line = {.time_s = camera.time_s,
                                          .camera = camera.place,
                                          .azimuth_rad = std::atan2(direction.x(), direction.y()),
                                          .elevation_rad = std::asin(std::clamp(direction.z(), -1.0, 1.0)),
                                          .range_m = object_pose.range_m,
                                          .sigma_rad = object_pose.sigma_rad},
                                 .heading_rad = std::nullopt,
                                 .sigma_position_m = camera.sigma_position_m,
                                 .sigma_attitude_rad = camera.sigma_attitude_rad};
  if (camera.clock_error) observation.line.clock_shift = ShiftOfLine(*camera.clock_error, direction);
  if (camera.sigma_focal) {
    observation.line.focal_shift = ShiftOfLine(*camera.sigma_focal, direction, enu_from_camera * Vector3d::UnitZ());
  }
  if (object_pose.range_m) observation.line.sigma_range_m = object_pose.sigma_range_m;
  if (object_pose.camera_from_object) {
    observation.heading_rad =
        HorizontalAzimuth(enu_from_camera * (object_pose.camera_from_object->rotation * Vector3d::UnitX()));
  }
  return observation;
}

std::int64_t NextRecognitionId(const SightingRecord& sighting, const BearingObservation* before,
                               std::int64_t& recognitions) {
  return sighting.source == SightingSource::kTracked && before != nullptr ? before->recognition_id : ++recognitions;
}

}  // namespace victorious
