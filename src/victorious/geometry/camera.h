// The pinhole camera. Its frame: x to the right of the image, y down, z along the optical axis; pixels as in box.h.
#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "victorious/geometry/rigid3.h"

namespace victorious {

/// x_px = fx X / Z + cx, y_px = fy Y / Z + cy.
struct PinholeCamera {
  double fx = 0;   ///< focal length, px, > 0
  double fy = 0;   ///< focal length, px, > 0
  double cx = 0;   ///< principal point, px from the image's left edge
  double cy = 0;   ///< principal point, px from the image's upper edge
  int width = 0;   ///< px
  int height = 0;  ///< px

  /// Where a point is seen, px, inside the image or beyond it; nothing for a point that is not in front of the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera) const {
    if (!(point_in_camera.z() > 0)) return std::nullopt;
    return Eigen::Vector2d(fx * point_in_camera.x() / point_in_camera.z() + cx,
                           fy * point_in_camera.y() / point_in_camera.z() + cy);
  }

  /// The point of a pixel's line of sight at depth 1; times a depth it is the point seen there.
  [[nodiscard]] Eigen::Vector3d RayOf(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
  }
};

/// The focal length of square pixels, px, of an image so wide.
/// @param hfov_rad  the full horizontal field of view, in (0, pi)
[[nodiscard]] inline double FocalLengthPx(double hfov_rad, double width_px) {
  return 0.5 * width_px / std::tan(0.5 * hfov_rad);
}

/// Square pixels, the principal point in the middle.
[[nodiscard]] inline PinholeCamera CentredPinhole(double hfov_rad, int width_px, int height_px) {
  const double focal = FocalLengthPx(hfov_rad, width_px);
  return {focal, focal, 0.5 * width_px, 0.5 * height_px, width_px, height_px};
}

/// A camera that stands somewhere.
struct PosedCamera {
  PinholeCamera pinhole;
  Rigid3 camera_from_world;
};

}  // namespace victorious
