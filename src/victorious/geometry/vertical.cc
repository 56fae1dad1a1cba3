#include "victorious/geometry/vertical.h"

#include <cmath>

namespace victorious {

Eigen::Vector3d Vertical::UpVectorAt(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d ray = pinhole.Unproject(pixel).normalized();
  // The smallest rotation from ray to axis is two reflections: ray to -axis, in the bisecting plane, then to axis.
  const Eigen::Vector3d middle = ray + axis;
  return up_in_camera - middle * (middle.dot(up_in_camera) / (1 + ray.z())) + 2 * axis * ray.dot(up_in_camera);
}

double Vertical::AzimuthAt(const Eigen::Vector2d& pixel) const {
  const auto level = [&](const Eigen::Vector3d& ray) -> Eigen::Vector3d {
    return ray - ray.dot(up_in_camera) * up_in_camera;
  };
  const Eigen::Vector3d ahead = level(azimuth_origin_in_camera);
  const Eigen::Vector3d there = level(pinhole.Unproject(pixel));
  return std::atan2(-up_in_camera.dot(ahead.cross(there)), ahead.dot(there));
}

Vertical MakeVertical(const Attitude& attitude, double hfov_rad, int width_px, int height_px) {
  const Eigen::Quaterniond camera_from_enu = CameraFromEnu(attitude);
  return {.pinhole = CentredPinhole(hfov_rad, width_px, height_px),
          .up_in_camera = camera_from_enu * Eigen::Vector3d::UnitZ(),
          .azimuth_origin_in_camera =
              camera_from_enu * Eigen::Vector3d(std::sin(attitude.yaw_rad), std::cos(attitude.yaw_rad), 0)};
}

Eigen::Vector3d ViewUpVector(double off_nadir_rad, double turn_rad) {
  return {std::sin(off_nadir_rad) * std::sin(turn_rad), -std::sin(off_nadir_rad) * std::cos(turn_rad),
          -std::cos(off_nadir_rad)};
}

}  // namespace victorious
