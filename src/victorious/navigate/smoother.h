// The most likely flight, given which sighting is of which landmark: a Gauss-Newton (Levenberg) iteration over the
// states of all frames at once, which is an iterated Kalman smoother in information form. Unknown are
//   of each frame  attitude, place, turn rate, velocity and, with telemetry, the offsets of what it tells
//   of all frames  where each landmark seen really is, and how turned
// tied to each other by
//   motion         turn rate and velocity change as random walks
//   telemetry      told = state + offset + noise; the offset walks from frame to frame
//   sightings      camera_from_landmark as seen
//   landmarks      as told, with their covariance
// Telemetry and sightings err by Student's t distribution: what is far off counts little.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/rigid3.h"
#include "victorious/navigate/bordered_system.h"
#include "victorious/navigate/landmark.h"

namespace victorious {

/// What telemetry tells of a frame, in the flight's tangent plane.
struct ToldPose {
  Eigen::Vector3d place;
  Attitude attitude;                  ///< against north and the vertical there
  Eigen::Quaterniond local_from_enu;  ///< from the tangent plane's axes to those there
  double sigma_position_m = 0;        ///< of its noise
  double sigma_attitude_rad = 0;      ///< likewise

  /// Without these offsets of yaw, pitch and roll.
  [[nodiscard]] Eigen::Quaterniond CameraFromEnuLess(const Eigen::Vector3d& attitude_offset) const;
};

struct FlightFrame {
  double time_s = 0;
  std::optional<ToldPose> told;
};

/// Of a frame; unknown are changes to it in this order, three each.
struct FlightState {
  Eigen::Quaterniond camera_from_enu = Eigen::Quaterniond::Identity();  ///< changed by a turn about camera's axes
  Eigen::Vector3d place = Eigen::Vector3d::Zero();                      ///< m, in the tangent plane
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();                  ///< rad/s, about the camera's axes
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();                   ///< m/s
  Eigen::Vector3d place_offset = Eigen::Vector3d::Zero();               ///< m, telemetry's: told less true
  Eigen::Vector3d attitude_offset = Eigen::Vector3d::Zero();            ///< rad, of yaw, pitch and roll
};

/// A landmark in the tangent plane; unknown are a turn about the plane's axes and a move along them.
struct FlightLandmark {
  Rigid3 enu_from_landmark;
  Matrix6 prior_covariance;  ///< of (turn, move) from what was told
};

/// A sighting taken as one of a landmark.
struct FlightTie {
  std::size_t frame = 0;
  std::size_t landmark = 0;
  Rigid3 camera_from_landmark;
  Matrix6 information;
};

struct FlightSigmas {
  double offset_position_m = 0;    ///< in the first frame
  double offset_attitude_rad = 0;  ///< likewise
  double drift_position_m = 0;     ///< in a second
  double drift_attitude_rad = 0;   ///< likewise
  double speed_m_s = 0;
  double speed_change_m_s = 0;  ///< in a second
  double turn_rad_s = 0;
  double turn_change_rad_s = 0;  ///< in a second
};

struct Flight {
  std::vector<FlightFrame> frames;
  FlightSigmas sigmas;
  bool has_told = false;  ///< any frame has telemetry: offsets are unknowns
};

/// A flight's estimate. Without covariances where there is none.
struct SmoothedFlight {
  std::vector<FlightState> states;  ///< one a frame
  std::vector<Rigid3> landmarks;    ///< enu_from_landmark, corrected
  BorderedSystem::Covariances covariances;
  double cost = 0;  ///< minus the logarithm of its likelihood
};

/// @param start      one a frame: near enough for an iteration
/// @param landmarks  only such as have a tie
/// Nothing where the equations cannot be solved.
std::optional<SmoothedFlight> SmoothFlight(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                           std::span<const FlightTie> ties, std::vector<FlightState> start);

/// How a sighting differs from how a landmark should be seen: (turn, move), see LandmarkSighting::information.
Vector6 SightingError(const Rigid3& seen, const FlightState& state, const Rigid3& enu_from_landmark);

/// Its derivative by (turn, place) of the state, and by (turn, move) of the landmark.
struct SightingJacobian {
  Matrix6 by_state;
  Matrix6 by_landmark;
};
SightingJacobian SightingDerivative(const FlightState& state, const Rigid3& enu_from_landmark);

/// How far off a sighting is, squared, in sigmas of its own and of what was expected together; infinity where what was
/// expected is no covariance.
double SquaredDistance(const Vector6& error, const Matrix6& information, const Matrix6& expected_covariance);

/// How many numbers a sighting tells: those with any information.
double DimensionsOf(const Matrix6& information);

}  // namespace victorious
