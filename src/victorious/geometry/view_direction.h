// The direction from which an object is seen, or lit: two angles (the thesis's longitude and latitude) and the unit
// vector.
//
// With d the unit vector from the object to the camera in the model frame (x front, y left, z up; types/mesh.h):
//   off_nadir = acos(d.z): 0 straight above
//   azimuth = atan2(d.y, -d.x): 0 behind the object, 90 degrees on its left, 180 in front
//   d = (-sin(off_nadir) cos(azimuth), sin(off_nadir) sin(azimuth), cos(off_nadir))
// In the image the model's up axis points upwards; straight from above its front does (the limit of azimuth 0).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious {

/// Direction from the object to the camera, or to the sun.
struct ViewDirection {
  double azimuth_rad = 0;    ///< about the model's up axis, as above; DirectionFromVector returns [0, 2 pi)
  double off_nadir_rad = 0;  ///< [0, pi]
};

/// The unit vector from the object to the camera, in the model frame.
[[nodiscard]] Eigen::Vector3d DirectionToCamera(const ViewDirection& direction);
[[nodiscard]] ViewDirection DirectionFromVector(const Eigen::Vector3d& object_to_camera);

/// The angle between two vectors, or two directions, radians, 0 to pi.
[[nodiscard]] double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
[[nodiscard]] double AngleBetween(const ViewDirection& a, const ViewDirection& b);

/// Rotation of a camera that looks at the object from a direction, with the image's up as defined above.
[[nodiscard]] Eigen::Quaterniond CameraFromModel(const ViewDirection& direction);

}  // namespace victorious
