// Which way is up along each line of sight of a frame, from how the camera was held.
//
// An object far away looks as its views do: the camera turned to look straight at it. Turned the shortest way, so that
// nothing rolls, the vertical is seen then at
//   up = (sin(off_nadir) sin(lean), -sin(off_nadir) cos(lean), -cos(off_nadir))
// in the camera's frame (camera.h): off_nadir of the line of sight, lean of the vertical's image, clockwise from the
// image's own up.
#pragma once

#include <Eigen/Core>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"

namespace victorious {

struct Vertical {
  PinholeCamera pinhole;
  Eigen::Vector3d up_in_camera = -Eigen::Vector3d::UnitZ();  ///< of length 1
  /// Where azimuths are counted from, whatever it is tipped by; not along `up_in_camera`.
  Eigen::Vector3d ahead_in_camera = Eigen::Vector3d::UnitZ();

  /// The vertical in the frame of the camera once it looks at `pixel`; of length 1.
  [[nodiscard]] Eigen::Vector3d SeenAt(const Eigen::Vector2d& pixel) const;

  /// Of the line of sight through `pixel`, clockwise seen from above, from where the camera is headed; (-pi, pi].
  [[nodiscard]] double AzimuthAt(const Eigen::Vector2d& pixel) const;
};

/// Of a camera with square pixels and its principal point at the image's centre.
/// @param hfov_rad  full horizontal field of view, (0, pi)
[[nodiscard]] Vertical MakeVertical(const Attitude& attitude, double hfov_rad, int width_px, int height_px);

/// Where a view from `off_nadir_rad` shows the object's own up, if it is turned by `turn_rad` in the image.
[[nodiscard]] Eigen::Vector3d UpOfView(double off_nadir_rad, double turn_rad);

}  // namespace victorious
