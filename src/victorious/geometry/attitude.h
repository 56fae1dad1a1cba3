// How a camera is held: yaw, pitch and roll against east, north and up. The camera's frame is that of camera.h.
//
// It starts level, looking north; turns by yaw about up (clockwise seen from above), then by pitch about its own right
// (up is positive, -90 degrees looks straight down), then by roll about its optical axis (its right side goes down):
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

/// Yaw in [0, 2 pi), roll in [-pi, pi]. Where the camera looks straight up or down only the sum or the difference of
/// yaw and roll is defined; roll is then 0.
[[nodiscard]] Attitude AttitudeOf(const Eigen::Quaterniond& camera_from_enu);

}  // namespace victorious
