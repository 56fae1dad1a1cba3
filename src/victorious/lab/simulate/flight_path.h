// Camera pose (extrinsics) at each time of a flight, and the pose of objects that drive.
//
// The camera pose is parametrised by the aim point (where the optical axis meets the ground), the direction (azimuth)
// and the off-nadir angle from there to the camera, the range and the roll. Each parameter is interpolated between
// knots at equal time steps: linearly, or by a Catmull-Rom spline (Catmull and Rom 1974), which passes through all
// knots and is smooth. Off-nadir angle and range are clamped to the limits of a scene. A circular flight has one aim
// point and a direction that turns.
//
// Camera shake: about each axis the sum of two sines with incommensurable frequencies (golden ratio) and random phases
// from the seed.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/lab/simulate/scene.h"

namespace victorious {

/// Intrinsics: square pixels, principal point at the image centre.
[[nodiscard]] PinholeCamera MakePinhole(const SceneVideo& video);

/// Extrinsics: camera frame (x right, y down, z forward) from town frame, metres.
/// @param fraction  of the flight: 0 at the first frame, 1 at the last
/// @param time_s    time of the frame, for the shake
/// @param seed      of the shake
[[nodiscard]] Rigid3 CameraFromTown(const SceneCamera& camera, double fraction, double time_s, std::uint64_t seed);

/// Position and heading on the ground, in the town frame.
struct GroundPose {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double heading_rad = 0;  ///< clockwise from the town's y axis
};

/// Pose of an object at a time. An object with a path drives along it at constant speed and stops at its end; one with
/// times is at each point of the path at its time, and its speed is continuous: the distance driven is a monotone cubic
/// of time (Fritsch and Carlson 1980), so that it stands still between two equal points. The path must have at least
/// two different points.
/// @param length_m  of the object: its front and its rear follow the path, so that it turns smoothly at corners
[[nodiscard]] GroundPose ComputeGroundPose(const SceneObject& object, double length_m, double time_s);

/// Velocity of that position, m/s in the town frame.
[[nodiscard]] Eigen::Vector2d ComputeGroundVelocity(const SceneObject& object, double length_m, double time_s);

}  // namespace victorious
