// Landmark navigation: known objects in view tell where the camera is and how it is held, with telemetry that drifts or
// without any.
//
//   landmarks, sightings -> which to believe (agreement.h, contradiction.h) -> the most likely flight (smoother.h) ->
//   which to believe after all, by how far each is from where the flight has it -> ... until that stays -> states with
//   covariance
//
// The inverse of geolocate/: there the camera is known and the object is sought.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/navigate/landmark.h"
#include "victorious/navigate/navigate_options.h"
#include "victorious/types/camera_state.h"

namespace victorious {

struct NavigationInput {
  std::span<const NavigationFrame> frames;  ///< by strictly rising time
  std::span<const CameraState> rows;        ///< telemetry as recorded, by time; tells how much its rows scatter
  std::span<const Landmark> landmarks;
  std::span<const std::vector<std::size_t>> landmarks_of;  ///< by number of model: which of the landmarks are of it
  std::span<const LandmarkSighting> sightings;             ///< by frame
  /// Of an error that all landmarks' places have in common: those located in one flight share its errors. It moves the
  /// flight as a whole, so nothing seen can tell it.
  Eigen::Matrix3d common_covariance_enu_m2 = Eigen::Matrix3d::Zero();
};

/// What telemetry told less what was so.
struct TelemetryOffset {
  Eigen::Vector3d place_enu_m;
  Eigen::Vector3d attitude_rad;  ///< of yaw, pitch and roll
  Matrix6 covariance;            ///< of both
};

/// Of one frame.
struct NavigatedFrame {
  CameraState camera;  ///< sigmas are root mean squares over the axes; no field of view
  Matrix6 covariance;  ///< of (place east, north, up in m; turn about the camera's right, down and forward in rad)
  int landmarks = 0;   ///< seen here and believed
  std::optional<TelemetryOffset> offset;  ///< where there is telemetry
};

struct Navigation {
  std::vector<NavigatedFrame> frames;                   ///< one a frame; none at all where nothing tells any place
  std::vector<std::optional<std::size_t>> landmark_of;  ///< one a sighting; none where it is not believed
};

/// Without telemetry and without a believed sighting there are no frames in the result.
/// Errors: kInvalidArgument for options out of range.
/// Cost: 0.2 to 0.4 ms a frame with a few landmarks. Each step of the smoother and its memory grow with frames x
/// landmarks seen, its covariances with frames x their square. With telemetry, of a model's landmarks those near what
/// it tells are tried, and at least 16; without it all are. Then, too, landmarks are held against each other two by
/// two (contradiction.h).
Expected<Navigation> Navigate(const NavigationInput& input, NavigateOptions options);

}  // namespace victorious
