// What landmark navigation starts from: objects whose place on Earth is known, and sightings of them.
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
  GeodeticPoint place;                                          ///< of the middle of its bounding box
  Eigen::Matrix3d covariance_enu_m2 = Eigen::Matrix3d::Zero();  ///< of the place; 0 where it is exact
  std::optional<double> heading_rad;                            ///< of its front, clockwise from north
  double sigma_heading_rad = 0;                                 ///< of a heading that is known
};

/// One object seen in one frame: how it stands before the camera. Its axes: x front, y left, z up, the origin in the
/// middle of its bounding box.
struct LandmarkSighting {
  std::size_t frame = 0;  ///< into the frames
  std::size_t model = 0;  ///< a number: any landmark of that model may be what is seen
  Rigid3 camera_from_landmark;
  /// Inverse covariance of its error (turn, move), rad and m: truth is the pose turned by `turn` about the camera's
  /// axes, then moved by `move` along them. What was not seen, such as the range or the turn of a photo's object, is 0.
  Matrix6 information = Matrix6::Zero();
};

/// A frame of the video, with what telemetry tells of it.
struct NavigationFrame {
  double time_s = 0;
  std::optional<CameraState> told;  ///< complete (CameraState::IsComplete) but for the field of view; at time_s
};

}  // namespace victorious
