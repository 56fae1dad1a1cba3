// Landmark navigation: estimates the camera's trajectory (position and attitude per frame) from sightings of objects at
// known places, with telemetry that drifts or without telemetry. Called by jobs/navigate/navigate_job.cc.
//
// Iterates between data association and smoothing:
//   landmarks, sightings -> initial association (agreement.h, contradiction.h)
//   -> maximum-likelihood flight (smoother.h) -> association by a gate on each sighting's innovation
//   -> ... until the association is stable -> states with covariance
//
// The inverse of geolocate/, where the camera is known and the object's place is estimated.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/place/navigate/landmark.h"
#include "victorious/place/navigate/navigate_options.h"
#include "victorious/types/camera_state.h"

namespace victorious {

struct NavigationInput {
  std::span<const NavigationFrame> frames;  ///< in strictly ascending order of time
  std::span<const CameraState> rows;        ///< telemetry as recorded, by time; determines the noise of its rows
  std::span<const Landmark> landmarks;
  std::span<const std::vector<std::size_t>> landmarks_by_model;  ///< by model index: the indices of its landmarks
  std::span<const LandmarkSighting> sightings;                   ///< ordered by frame
  /// Covariance of an error that is common to all landmarks' places, for example if all were located in one flight. It
  /// shifts the flight as a whole and is unobservable.
  Eigen::Matrix3d common_covariance_enu_m2 = Eigen::Matrix3d::Zero();
};

/// The error of telemetry: measured minus estimated.
struct TelemetryOffset {
  Eigen::Vector3d place_enu_m;
  Eigen::Vector3d attitude_rad;  ///< of yaw, pitch and roll
  Matrix6 covariance;            ///< of both: (place, attitude)
};

/// The estimate for one frame.
struct NavigatedFrame {
  CameraState camera;  ///< its sigmas are root mean squares over the axes; without field of view
  /// of (place east, north, up in m; rotation about the camera's right, down and forward axes in rad)
  Matrix6 covariance;
  int landmarks = 0;                      ///< number of landmarks associated with a sighting in this frame
  std::optional<TelemetryOffset> offset;  ///< std::nullopt for frames without telemetry
};

/// Why there are frames, or none.
enum class NavigationStatus {
  kOk,
  kNothingObserved,  ///< no sighting of a landmark, and no telemetry
  kUnsolvable,       ///< the equations of the flight have no solution: information or covariances that are not finite
};

inline constexpr auto kNavigationStatusTexts = std::to_array<EnumText<NavigationStatus>>(
    {{NavigationStatus::kOk, "ok"},
     {NavigationStatus::kNothingObserved, "no landmark recognised and no telemetry"},
     {NavigationStatus::kUnsolvable, "the equations of the flight have no solution"}});

struct Navigation {
  NavigationStatus status = NavigationStatus::kOk;
  std::vector<NavigatedFrame> frames;                            ///< one per frame; empty unless the status is kOk
  std::vector<std::optional<std::size_t>> landmark_by_sighting;  ///< one per sighting; std::nullopt for outliers
};

/// Estimates the flight. Without telemetry and without an associated sighting the result has no frames, and a status
/// that says so. Errors: kInvalidArgument for options out of range. Cost: 0.2 to 0.4 ms per frame with a few landmarks.
/// Each iteration of the smoother and its memory are linear in frames x landmarks in view, the covariances in frames x
/// the square of the landmarks in view. With telemetry, of each model only the landmarks near the predicted position,
/// and at least 16, are candidates; without telemetry all are, and landmarks are also compared pairwise
/// (contradiction.h).
[[nodiscard]] Expected<Navigation> Navigate(const NavigationInput& input, NavigateOptions options);

}  // namespace victorious
