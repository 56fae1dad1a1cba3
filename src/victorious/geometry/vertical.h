// The direction of the vertical along each line of sight of a frame, from the camera's attitude. Used to restrict the
// views and in-plane rotations of upright objects (recognize/, search/pose/upright_prior.h).
//
// A distant object looks like its view, rendered by a virtual camera that looks straight at it. If the camera is
// rotated onto the line of sight by the smallest rotation (no roll), the vertical is
//   up = (sin(off_nadir) sin(lean), -sin(off_nadir) cos(lean), -cos(off_nadir))
// in the rotated camera's frame (camera.h): off_nadir of the line of sight, lean of the image of the vertical,
// clockwise from the image's up direction.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"

namespace victorious {

struct Vertical {
  PinholeCamera pinhole;
  Eigen::Vector3d up_in_camera = -Eigen::Vector3d::UnitZ();  ///< unit vector
  /// The direction of azimuth 0, with any inclination; not parallel to `up_in_camera`.
  Eigen::Vector3d azimuth_origin_in_camera = Eigen::Vector3d::UnitZ();

  /// The vertical (unit vector) in the frame of the camera rotated to look at `pixel`.
  [[nodiscard]] Eigen::Vector3d UpVectorAt(const Eigen::Vector2d& pixel) const;

  /// The angle of the vertical's image at `pixel`, clockwise from the image's up direction ("lean" above); (-pi, pi].
  [[nodiscard]] double LeanAt(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d up = UpVectorAt(pixel);
    return std::atan2(up.x(), -up.y());
  }

  /// Azimuth of the line of sight through `pixel`, clockwise seen from above, relative to the camera's heading; (-pi,
  /// pi].
  [[nodiscard]] double AzimuthAt(const Eigen::Vector2d& pixel) const;
};

/// Makes the Vertical of a camera with square pixels and its principal point at the image centre.
/// @param hfov_rad  full horizontal field of view, (0, pi)
[[nodiscard]] Vertical MakeVertical(const Attitude& attitude, double hfov_rad, int width_px, int height_px);

/// The object's up axis (unit vector) in the camera frame of a view from `off_nadir_rad`, rotated by `turn_rad` in the
/// image.
[[nodiscard]] Eigen::Vector3d ViewUpVector(double off_nadir_rad, double turn_rad);

}  // namespace victorious
