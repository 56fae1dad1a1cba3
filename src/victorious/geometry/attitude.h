// Camera attitude: yaw, pitch and roll relative to east, north, up (ENU). The camera frame is that of camera.h.
//
// Zero attitude is level, looking north. Yaw rotates about up (clockwise seen from above), then pitch about the
// camera's right axis (positive up, -90 degrees looks straight down), then roll about the optical axis (right side
// down):
//   enu_from_camera = Rz(-yaw) Rx(pitch) B Rz(roll),  B: right -> east, down -> -up, forward -> north
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious {

struct Attitude {
  double yaw_rad = 0;    ///< of the optical axis, clockwise from north
  double pitch_rad = 0;  ///< of the optical axis above the horizon, [-pi/2, pi/2]
  double roll_rad = 0;   ///< about the optical axis, positive when the camera's right side goes down
};

[[nodiscard]] Eigen::Quaterniond CameraFromEnu(const Attitude& attitude);

/// The inverse of CameraFromEnu. Yaw in [0, 2 pi), roll in [-pi, pi]. If the camera looks straight up or down, only the
/// sum or the difference of yaw and roll is defined; roll is then 0.
[[nodiscard]] Attitude AttitudeFromRotation(const Eigen::Quaterniond& camera_from_enu);

}  // namespace victorious
