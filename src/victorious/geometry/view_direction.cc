#include "victorious/geometry/view_direction.h"

#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

using Eigen::Vector3d;

namespace {

// The up direction of the image in the model frame: the direction of decreasing off-nadir angle.
Vector3d ImageUp(const ViewDirection& direction) {
  const double c = std::cos(direction.off_nadir_rad);
  return {c * std::cos(direction.azimuth_rad), -c * std::sin(direction.azimuth_rad), std::sin(direction.off_nadir_rad)};
}

}  // namespace

Vector3d DirectionToCamera(const ViewDirection& direction) {
  const double s = std::sin(direction.off_nadir_rad);
  return {-s * std::cos(direction.azimuth_rad), s * std::sin(direction.azimuth_rad), std::cos(direction.off_nadir_rad)};
}

ViewDirection DirectionFromVector(const Vector3d& object_to_camera) {
  const double sideways = std::hypot(object_to_camera.x(), object_to_camera.y());
  const double azimuth = sideways > 0 ? std::atan2(object_to_camera.y(), -object_to_camera.x()) : 0.0;
  return {.azimuth_rad = azimuth < 0 ? azimuth + 2 * kPi : azimuth,
          .off_nadir_rad = std::atan2(sideways, object_to_camera.z())};
}

double AngleBetween(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

double AngleBetween(const ViewDirection& a, const ViewDirection& b) {
  return AngleBetween(DirectionToCamera(a), DirectionToCamera(b));
}

Eigen::Quaterniond CameraFromModel(const ViewDirection& direction) {
  const Vector3d to_camera = DirectionToCamera(direction);
  const Vector3d up = ImageUp(direction);
  Eigen::Matrix3d rotation;
  rotation << up.cross(to_camera).transpose(), -up.transpose(), -to_camera.transpose();
  return Eigen::Quaterniond(rotation);
}

}  // namespace victorious
