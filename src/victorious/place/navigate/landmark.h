// The input types of landmark navigation: landmarks (objects at known places), sightings of them, and video frames.
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/types/camera_state.h"

namespace victorious {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// An object that stands upright at a known place.
struct Landmark {
  std::string model;
  GeodeticPoint place;                                          ///< of the centre of its bounding box
  Eigen::Matrix3d covariance_enu_m2 = Eigen::Matrix3d::Zero();  ///< of the place; 0 if it is exact
  std::optional<double> heading_rad;  ///< of its front, clockwise from north; std::nullopt if not known
  double sigma_heading_rad = 0;       ///< of the heading, if known
};

/// One sighting: the pose of an object relative to the camera in one frame. Object axes: x front, y left, z up, origin
/// at the centre of its bounding box.
struct LandmarkSighting {
  std::size_t frame = 0;  ///< index into the frames
  std::size_t model = 0;  ///< model index: the sighting may be of any landmark of that model
  Rigid3 camera_from_landmark;
  /// Inverse covariance of the error (rotation, translation), rad and m: the true pose is the estimated one, rotated
  /// about the camera's axes, then translated along them. Zero for components that were not observed, such as the range
  /// or the rotation of an object modelled from photos.
  Matrix6 information = Matrix6::Zero();
};

/// A frame of the video, with the camera state measured by telemetry.
struct NavigationFrame {
  double time_s = 0;
  std::optional<CameraState> measured;  ///< complete (CameraState::IsComplete) except for the field of view; at time_s
};

}  // namespace victorious
