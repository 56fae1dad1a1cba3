// Maximum-likelihood estimate of the flight for a given data association: Levenberg-Marquardt over the states of all
// frames at once, i.e. an iterated Kalman smoother in information form. The unknowns are
//   per frame     attitude, place, angular rate, velocity and, with telemetry, the offsets of telemetry
//   per landmark  the true place and rotation of each observed landmark
// coupled by
//   motion        angular rate and velocity change as random walks
//   telemetry     measured = state + offset + noise; the offset is a random walk from frame to frame
//   sightings     camera_from_landmark as observed
//   landmarks     the given places, with their covariance
// Telemetry and sightings have Student's t errors: outliers have little influence.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/geometry/rigid3.h"
#include "victorious/place/navigate/bordered_system.h"
#include "victorious/place/navigate/landmark.h"

namespace victorious {

/// The camera pose measured by telemetry in one frame, in the flight's tangent plane.
struct TelemetryPose {
  Eigen::Vector3d place;
  Attitude attitude;                  ///< relative to north and the local vertical
  Eigen::Quaterniond local_from_enu;  ///< rotation from the tangent plane's axes to the local ones
  double sigma_position_m = 0;        ///< of the noise
  double sigma_attitude_rad = 0;      ///< of the noise

  /// The camera's rotation after subtraction of these offsets of yaw, pitch and roll.
  [[nodiscard]] Eigen::Quaterniond CorrectedCameraFromEnu(const Eigen::Vector3d& attitude_offset) const;
};

struct FlightFrame {
  double time_s = 0;
  std::optional<TelemetryPose> measured;
};

/// The state of a frame. The unknowns are increments to its members in this order, three each.
struct FlightState {
  Eigen::Quaterniond camera_from_enu = Eigen::Quaterniond::Identity();  ///< increment: rotation about the camera's axes
  Eigen::Vector3d place = Eigen::Vector3d::Zero();                      ///< m, in the tangent plane
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();               ///< rad/s, about the camera's axes
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();                   ///< m/s
  Eigen::Vector3d place_offset = Eigen::Vector3d::Zero();               ///< m, of telemetry: measured minus true
  Eigen::Vector3d attitude_offset = Eigen::Vector3d::Zero();            ///< rad, of yaw, pitch and roll
};

/// A landmark in the tangent plane. The unknowns are a rotation about the plane's axes and a translation along them.
struct FlightLandmark {
  Rigid3 enu_from_landmark;
  Matrix6 prior_covariance;  ///< of (rotation, translation), from the given place and heading; one that is not a
                             ///< covariance (InvertCovariance) adds no information: the landmark is then free
};

/// A sighting associated with a landmark.
struct SightingConstraint {
  std::size_t frame = 0;
  std::size_t landmark = 0;
  Rigid3 camera_from_landmark;
  Matrix6 information;
};

/// Standard deviations of the process model, along or about each axis.
struct FlightSigmas {
  double offset_position_m = 0;    ///< initial
  double offset_attitude_rad = 0;  ///< initial
  double drift_position_m = 0;     ///< of the random walk, after one second
  double drift_attitude_rad = 0;   ///< after one second
  double speed_m_s = 0;
  double speed_change_m_s = 0;  ///< of the random walk, after one second
  double angular_rate_rad_s = 0;
  double angular_rate_change_rad_s = 0;  ///< of the random walk, after one second
};

struct FlightInput {
  std::vector<FlightFrame> frames;
  FlightSigmas sigmas;
  bool has_telemetry = false;  ///< true if any frame has telemetry: the offsets are then unknowns
};

/// The estimated flight.
struct SmoothedFlight {
  std::vector<FlightState> states;  ///< one per frame
  std::vector<Rigid3> landmarks;    ///< enu_from_landmark, estimated
  BorderedSystem::Covariances covariances;
  double cost = 0;  ///< negative log-likelihood
};

/// Estimates the flight.
/// @param start      one per frame: within the convergence region
/// @param landmarks  only those with at least one constraint
/// @return std::nullopt if the equations cannot be solved
std::optional<SmoothedFlight> SmoothFlight(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                                           std::span<const SightingConstraint> constraints,
                                           std::vector<FlightState> start);

/// The residual of a sighting: (rotation, translation), predicted relative to observed; see
/// LandmarkSighting::information.
Vector6 SightingError(const Rigid3& seen, const FlightState& state, const Rigid3& enu_from_landmark);

/// Jacobians of the residual by (rotation, place) of the state, and by (rotation, translation) of the landmark.
struct SightingJacobian {
  Matrix6 by_state;
  Matrix6 by_landmark;
};
SightingJacobian ComputeSightingJacobian(const FlightState& state, const Rigid3& enu_from_landmark);

/// The covariance of a predicted sighting whose landmark is no unknown of the flight, so that state and landmark are
/// independent.
/// @param of_state  covariance of (rotation, place)
Matrix6 PredictionCovariance(const SightingJacobian& jacobian, const Matrix6& of_state, const Matrix6& of_landmark);

/// The normalised innovation squared of a sighting: the squared Mahalanobis distance under the sum of its own
/// covariance and that of the prediction; infinity if `expected_covariance` is not a covariance.
double NormalisedInnovationSquared(const Vector6& error, const Matrix6& information,
                                   const Matrix6& expected_covariance);

/// Degrees of freedom of Student's t distribution of the errors of telemetry and of sightings: heavier tails than a
/// normal distribution, and a finite fourth moment. Chosen, not fitted.
inline constexpr double kStudentDegreesOfFreedom = 6;

/// The number of components of a sighting with any information.
double CountObservedDimensions(const Matrix6& information);

}  // namespace victorious
