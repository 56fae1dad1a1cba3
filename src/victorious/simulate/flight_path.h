// Where the camera is, and how it is held, at each time of a flight; and where a thing that drives is.
//
// The camera is described by what it looks at: the point of the ground on its optical axis, the direction and the
// off-nadir angle it is seen under from there, the range, the roll. Each is a track of knots spread evenly over the
// flight, joined by lines or by a Catmull-Rom curve (Catmull and Rom 1974), which passes through all knots without a
// corner; the off-nadir angle and the range stay within what a scene may ask for. A circle is one aim and a direction
// that turns.
//
// Shake is two sines about each axis, of frequencies that have no common period, with phases drawn by seed.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/simulate/scene.h"

namespace victorious {

/// Square pixels, the principal point in the middle.
[[nodiscard]] PinholeCamera PinholeOf(const SceneVideo& video);

/// @param fraction  of the flight, 0 at the first frame, 1 at the last
/// @param time_s    of the frame, for the shake
/// @param seed      of the shake
[[nodiscard]] Rigid3 CameraFromTown(const SceneCamera& camera, double fraction, double time_s, std::uint64_t seed);

/// A place on the ground and a direction, in the town's frame.
struct GroundPose {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double heading_rad = 0;  ///< clockwise from the town's y axis
};

/// Where an object stands, or drives: along its path, whose points are not all the same, from the first on, round the
/// corners, to the end of it.
/// @param length_m  of the object, over which it cuts corners
[[nodiscard]] GroundPose GroundPoseOf(const SceneObject& object, double length_m, double time_s);

}  // namespace victorious
