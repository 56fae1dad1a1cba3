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

  /// Projects a point to pixel coordinates, inside the image or beyond it; std::nullopt for a point that is not in
  /// front of the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera) const {
    if (!(point_in_camera.z() > 0)) return std::nullopt;
    return Eigen::Vector2d(fx * point_in_camera.x() / point_in_camera.z() + cx,
                           fy * point_in_camera.y() / point_in_camera.z() + cy);
  }

  /// The point at depth 1 on the pixel's line of sight, in the camera frame; scaled by a depth it is the 3D point.
  [[nodiscard]] Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
  }
};

/// The focal length in pixels of an image of this width, for square pixels.
[[nodiscard]] inline double FocalLengthPx(double hfov_rad, double width_px) {
  return 0.5 * width_px / std::tan(0.5 * hfov_rad);
}

/// A camera with square pixels and the principal point at the image centre.
[[nodiscard]] inline PinholeCamera CentredPinhole(double hfov_rad, int width_px, int height_px) {
  const double focal = FocalLengthPx(hfov_rad, width_px);
  return {focal, focal, 0.5 * width_px, 0.5 * height_px, width_px, height_px};
}

/// A camera with its pose in the world.
struct PosedCamera {
  PinholeCamera pinhole;
  Rigid3 camera_from_world;
};

}  // namespace victorious
