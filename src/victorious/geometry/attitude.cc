#include "victorious/geometry/attitude.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Quaterniond CameraFromEnu(const Attitude& attitude) {
  Matrix3d level_from_camera;
  level_from_camera << 1, 0, 0,  //
      0, 0, 1,                   //
      0, -1, 0;
  const Quaterniond enu_from_camera = AngleAxisd(-attitude.yaw_rad, Vector3d::UnitZ()) *
                                      AngleAxisd(attitude.pitch_rad, Vector3d::UnitX()) *
                                      Quaterniond(level_from_camera) * AngleAxisd(attitude.roll_rad, Vector3d::UnitZ());
  return enu_from_camera.conjugate();
}

Attitude AttitudeFromRotation(const Quaterniond& camera_from_enu) {
  const Matrix3d enu_from_camera = camera_from_enu.conjugate().toRotationMatrix();
  const Vector3d right = enu_from_camera.col(0);
  const Vector3d forward = enu_from_camera.col(2);
  Attitude attitude;
  attitude.pitch_rad = std::asin(std::clamp(forward.z(), -1.0, 1.0));
  constexpr double kVertical = 1e-9;  // horizontal component of the optical axis
  const bool vertical = forward.head<2>().norm() < kVertical;
  // The right axis of a camera without roll is horizontal, 90 degrees clockwise from its yaw.
  attitude.yaw_rad = vertical ? std::atan2(-right.y(), right.x()) : std::atan2(forward.x(), forward.y());
  if (!vertical) {
    const Vector3d level_right(std::cos(attitude.yaw_rad), -std::sin(attitude.yaw_rad), 0);
    attitude.roll_rad = std::atan2(right.dot(forward.cross(level_right)), right.dot(level_right));
  }
  if (attitude.yaw_rad < 0) attitude.yaw_rad += 2 * kPi;
  return attitude;
}

}  // namespace victorious
