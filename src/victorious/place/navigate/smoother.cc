#include "victorious/place/navigate/smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/place/navigate/covariance.h"

namespace victorious {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

// Index of each unknown in a frame's block.
constexpr Index kTurn = 0;
constexpr Index kPlace = 3;
constexpr Index kAngularRate = 6;
constexpr Index kVelocity = 9;
constexpr Index kPlaceOffset = 12;
constexpr Index kAttitudeOffset = 15;
constexpr Index kWithoutOffsets = 12;
constexpr Index kWithOffsets = 18;

// Standard deviation of the prior of the first place, m: no information.
constexpr double kUninformativeSigma_m = 1e5;

// Minimum time between frames, s: clocks may stand still.
constexpr double kMinStep_s = 1e-3;

// Minimum standard deviations of telemetry's drift after one second: they keep the system well-conditioned.
constexpr double kMinDrift_m = 1e-3;
constexpr double kMinDrift_rad = 1e-5;

// Step of the numerical derivative by telemetry's attitude offset, rad: far above rounding, far below a radian.
constexpr double kStep_rad = 1e-5;

// Levenberg-Marquardt: maximum number of steps, the gain in cost below which it has converged (the cost is half a sum
// of squared normalised residuals), and the damping beyond which no step lowers the cost.
constexpr int kMaxSteps = 40;
constexpr double kTolerance = 1e-3;
constexpr double kMaxDamping = 1e8;

double InverseSquare(double sigma) { return 1 / (sigma * sigma); }

// Robust error model, a t distribution of `count` residuals whose normalised squares sum to `squared`: the negative
// log-likelihood, and the weight relative to a normal distribution.
struct StudentT {
  StudentT(double squared, double count)
      : cost(0.5 * (kStudentDegreesOfFreedom + count) * std::log1p(squared / kStudentDegreesOfFreedom)),
        weight((kStudentDegreesOfFreedom + count) / (kStudentDegreesOfFreedom + squared)) {}

  double cost;
  double weight;
};

struct Estimate {
  std::vector<FlightState> states;
  std::vector<Rigid3> landmarks;
};

// Information of (value, rate) for a value whose rate changes by white noise, after time dt (constant-velocity model).
Matrix12 MotionInformation(double dt, const FlightSigmas& sigmas) {
  Matrix12 information = Matrix12::Zero();
  const auto fill = [&](Index number, Index rate, double change) {
    const double q = change * change;
    for (Index axis = 0; axis < 3; ++axis) {
      information(number + axis, number + axis) = 12 / (q * dt * dt * dt);
      information(rate + axis, rate + axis) = 4 / (q * dt);
      information(number + axis, rate + axis) = information(rate + axis, number + axis) = -6 / (q * dt * dt);
    }
  };
  fill(kTurn, kAngularRate, sigmas.angular_rate_change_rad_s);
  fill(kPlace, kVelocity, sigmas.speed_change_m_s);
  return information;
}

class Smoother {
 public:
  Smoother(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
           std::span<const SightingConstraint> constraints)
      : flight_(flight), landmarks_(landmarks), constraints_(constraints) {
    for (const FlightLandmark& landmark : landmarks) {
      // A singular prior adds no information.
      landmark_information_.push_back(InvertCovariance(landmark.prior_covariance).value_or(Matrix6::Zero()));
    }
  }

  /// The negative log-likelihood of the estimate. Adds its normal equations to `system`, if given.
  double Evaluate(const Estimate& estimate, BorderedSystem* system) const {
    double cost = AddInitialPrior(estimate, system);
    for (std::size_t k = 0; k < flight_.frames.size(); ++k) {
      if (k > 0) cost += AddMotionCost(estimate, k - 1, system);
      if (flight_.frames[k].measured) cost += AddTelemetryCost(estimate, k, system);
    }
    for (std::size_t i = 0; i < landmarks_.size(); ++i) cost += AddLandmarkPrior(estimate, i, system);
    for (const SightingConstraint& constraint : constraints_) cost += AddSightingCost(estimate, constraint, system);
    return cost;
  }

  [[nodiscard]] BorderedSystem EmptySystem() const {
    return {flight_.frames.size(), flight_.has_telemetry ? kWithOffsets : kWithoutOffsets,
            6 * static_cast<Index>(landmarks_.size())};
  }

  [[nodiscard]] Estimate ApplyStep(const Estimate& estimate, const BorderedSystem::Solution& step) const {
    Estimate moved = estimate;
    for (std::size_t k = 0; k < moved.states.size(); ++k) {
      const Eigen::VectorXd& change = step.blocks[k];
      FlightState& state = moved.states[k];
      state.camera_from_enu = (RotationFromVector(change.segment<3>(kTurn)) * state.camera_from_enu).normalized();
      state.place += change.segment<3>(kPlace);
      state.angular_rate += change.segment<3>(kAngularRate);
      state.velocity += change.segment<3>(kVelocity);
      if (!flight_.has_telemetry) continue;
      state.place_offset += change.segment<3>(kPlaceOffset);
      state.attitude_offset += change.segment<3>(kAttitudeOffset);
    }
    for (std::size_t i = 0; i < moved.landmarks.size(); ++i) {
      const Vector6 change = step.border.segment<6>(6 * static_cast<Index>(i));
      Rigid3& pose = moved.landmarks[i];
      pose.rotation = (RotationFromVector(change.head<3>()) * pose.rotation).normalized();
      pose.translation += change.tail<3>();
    }
    return moved;
  }

 private:
  // Prior of the first state: wide in the pose; sigmas for the velocities and for the telemetry offset.
  double AddInitialPrior(const Estimate& estimate, BorderedSystem* system) const {
    const FlightSigmas& sigmas = flight_.sigmas;
    const FlightState& first = estimate.states.front();
    double cost = 0;
    const auto constraint = [&](Index at, const Vector3d& value, double sigma) {
      const double weight = InverseSquare(sigma);
      cost += 0.5 * weight * value.squaredNorm();
      if (system == nullptr) return;
      system->diagonal.front().diagonal().segment<3>(at).array() += weight;
      system->rhs.front().segment<3>(at) -= weight * value;
    };
    constraint(kTurn, Vector3d::Zero(), kPi);
    constraint(kPlace, Vector3d::Zero(), kUninformativeSigma_m);
    constraint(kAngularRate, first.angular_rate, sigmas.angular_rate_rad_s);
    constraint(kVelocity, first.velocity, sigmas.speed_m_s);
    if (!flight_.has_telemetry) return cost;
    // Heavy tails: a telemetry offset far above its sigma does not dominate the estimate.
    const auto robust_constraint = [&](Index at, const Vector3d& value, double sigma) {
      const double squared = value.squaredNorm() * InverseSquare(sigma);
      const StudentT student_t(squared, 3);
      constraint(at, value, sigma / std::sqrt(student_t.weight));
      cost += student_t.cost - 0.5 * student_t.weight * squared;
    };
    robust_constraint(kPlaceOffset, first.place_offset, sigmas.offset_position_m);
    robust_constraint(kAttitudeOffset, first.attitude_offset, sigmas.offset_attitude_rad);
    return cost;
  }

  // Motion model from frame k to the next.
  double AddMotionCost(const Estimate& estimate, std::size_t k, BorderedSystem* system) const {
    const double dt = std::max(kMinStep_s, flight_.frames[k + 1].time_s - flight_.frames[k].time_s);
    const FlightState& now = estimate.states[k];
    const FlightState& next = estimate.states[k + 1];
    const Quaterniond turn = RotationFromVector(now.angular_rate * dt);
    Vector12 residual;
    residual << VectorFromRotation(next.camera_from_enu * (turn * now.camera_from_enu).conjugate()),
        next.place - now.place - dt * now.velocity, next.angular_rate - now.angular_rate, next.velocity - now.velocity;
    const Matrix12 information = MotionInformation(dt, flight_.sigmas);
    double cost = 0.5 * residual.dot(information * residual);
    if (system != nullptr) {
      Matrix12 by_now = -Matrix12::Identity();
      by_now.block<3, 3>(kTurn, kTurn) = -turn.toRotationMatrix();
      by_now.block<3, 3>(kTurn, kAngularRate) = -dt * Matrix3d::Identity();
      by_now.block<3, 3>(kPlace, kVelocity) = -dt * Matrix3d::Identity();
      const Matrix12 weighted = by_now.transpose() * information;  // by_next is the identity
      system->diagonal[k].topLeftCorner<12, 12>() += weighted * by_now;
      system->diagonal[k + 1].topLeftCorner<12, 12>() += information;
      system->upper[k].topLeftCorner<12, 12>() += weighted;
      system->rhs[k].head<12>() -= weighted * residual;
      system->rhs[k + 1].head<12>() -= information * residual;
    }
    if (!flight_.has_telemetry) return cost;
    const auto random_walk = [&](Index at, const Vector3d& change, double drift, double min_drift) {
      const double precision = 1 / (dt * std::max(drift * drift, min_drift * min_drift));
      const StudentT student_t(precision * change.squaredNorm(), 3);  // telemetry may jump
      const double weight = student_t.weight * precision;
      cost += student_t.cost;
      if (system == nullptr) return;
      system->diagonal[k].diagonal().segment<3>(at).array() += weight;
      system->diagonal[k + 1].diagonal().segment<3>(at).array() += weight;
      system->upper[k].diagonal().segment<3>(at).array() -= weight;
      system->rhs[k].segment<3>(at) += weight * change;
      system->rhs[k + 1].segment<3>(at) -= weight * change;
    };
    random_walk(kPlaceOffset, next.place_offset - now.place_offset, flight_.sigmas.drift_position_m, kMinDrift_m);
    random_walk(kAttitudeOffset, next.attitude_offset - now.attitude_offset, flight_.sigmas.drift_attitude_rad,
                kMinDrift_rad);
    return cost;
  }

  double AddTelemetryCost(const Estimate& estimate, std::size_t k, BorderedSystem* system) const {
    const TelemetryPose& measured = *flight_.frames[k].measured;
    const FlightState& state = estimate.states[k];
    const Vector3d place_off = state.place + state.place_offset - measured.place;
    const Quaterniond expected = measured.CorrectedCameraFromEnu(state.attitude_offset);
    const Vector3d attitude_off = VectorFromRotation(state.camera_from_enu * expected.conjugate());
    const StudentT place_t(place_off.squaredNorm() * InverseSquare(measured.sigma_position_m), 3);
    const StudentT attitude_t(attitude_off.squaredNorm() * InverseSquare(measured.sigma_attitude_rad), 3);
    const double place_weight = place_t.weight * InverseSquare(measured.sigma_position_m);
    const double attitude_weight = attitude_t.weight * InverseSquare(measured.sigma_attitude_rad);
    const double cost = place_t.cost + attitude_t.cost;
    if (system == nullptr) return cost;
    MatrixXd& block = system->diagonal[k];
    Eigen::VectorXd& rhs = system->rhs[k];
    for (const Index at : {kPlace, kPlaceOffset}) {
      block.diagonal().segment<3>(at).array() += place_weight;
      rhs.segment<3>(at) -= place_weight * place_off;
    }
    block.block<3, 3>(kPlace, kPlaceOffset).diagonal().array() += place_weight;
    block.block<3, 3>(kPlaceOffset, kPlace).diagonal().array() += place_weight;
    Matrix3d by_offset;
    for (Index axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStep_rad * Vector3d::Unit(axis);
      const Quaterniond more = measured.CorrectedCameraFromEnu(state.attitude_offset + step);
      by_offset.col(axis) = VectorFromRotation(expected * more.conjugate()) / kStep_rad;
    }
    block.block<3, 3>(kTurn, kTurn).diagonal().array() += attitude_weight;
    block.block<3, 3>(kTurn, kAttitudeOffset) += attitude_weight * by_offset;
    block.block<3, 3>(kAttitudeOffset, kTurn) += attitude_weight * by_offset.transpose();
    block.block<3, 3>(kAttitudeOffset, kAttitudeOffset) += attitude_weight * by_offset.transpose() * by_offset;
    rhs.segment<3>(kTurn) -= attitude_weight * attitude_off;
    rhs.segment<3>(kAttitudeOffset) -= attitude_weight * by_offset.transpose() * attitude_off;
    return cost;
  }

  double AddLandmarkPrior(const Estimate& estimate, std::size_t i, BorderedSystem* system) const {
    const Rigid3& measured = landmarks_[i].enu_from_landmark;
    const Rigid3& now = estimate.landmarks[i];
    Vector6 residual;
    residual << VectorFromRotation(now.rotation * measured.rotation.conjugate()),
        now.translation - measured.translation;
    const Matrix6& information = landmark_information_[i];
    if (system != nullptr) {
      const Index at = 6 * static_cast<Index>(i);
      system->corner.block<6, 6>(at, at) += information;
      system->corner_rhs.segment<6>(at) -= information * residual;
    }
    return 0.5 * residual.dot(information * residual);
  }

  double AddSightingCost(const Estimate& estimate, const SightingConstraint& constraint, BorderedSystem* system) const {
    const FlightState& state = estimate.states[constraint.frame];
    const Rigid3& landmark = estimate.landmarks[constraint.landmark];
    const Vector6 residual = SightingError(constraint.camera_from_landmark, state, landmark);
    const double squared = residual.dot(constraint.information * residual);
    const StudentT student_t(squared, CountObservedDimensions(constraint.information));
    if (system != nullptr) {
      const Matrix6 information = student_t.weight * constraint.information;
      const SightingJacobian jacobian = ComputeSightingJacobian(state, landmark);
      const Index at = 6 * static_cast<Index>(constraint.landmark);
      const Matrix6 state_weighted = jacobian.by_state.transpose() * information;
      const Matrix6 landmark_weighted = jacobian.by_landmark.transpose() * information;
      system->diagonal[constraint.frame].topLeftCorner<6, 6>() += state_weighted * jacobian.by_state;
      BorderedSystem::Part& part = system->border[constraint.frame].emplace_back();
      part = {at, MatrixXd::Zero(system->block_size(), 6)};
      part.columns.topRows<6>() = state_weighted * jacobian.by_landmark;
      system->corner.block<6, 6>(at, at) += landmark_weighted * jacobian.by_landmark;
      system->rhs[constraint.frame].head<6>() -= state_weighted * residual;
      system->corner_rhs.segment<6>(at) -= landmark_weighted * residual;
    }
    return student_t.cost;
  }

  const FlightInput& flight_;
  std::span<const FlightLandmark> landmarks_;
  std::span<const SightingConstraint> constraints_;
  std::vector<Matrix6> landmark_information_;
};

}  // namespace

Quaterniond TelemetryPose::CorrectedCameraFromEnu(const Vector3d& attitude_offset) const {
  return CameraFromEnu({attitude.yaw_rad - attitude_offset[0], attitude.pitch_rad - attitude_offset[1],
                        attitude.roll_rad - attitude_offset[2]}) *
         local_from_enu;
}

Vector6 SightingError(const Rigid3& seen, const FlightState& state, const Rigid3& enu_from_landmark) {
  const Quaterniond rotation = state.camera_from_enu * enu_from_landmark.rotation;
  Vector6 residual;
  residual << VectorFromRotation(rotation * seen.rotation.conjugate()),
      state.camera_from_enu * (enu_from_landmark.translation - state.place) - seen.translation;
  return residual;
}

SightingJacobian ComputeSightingJacobian(const FlightState& state, const Rigid3& enu_from_landmark) {
  const Matrix3d camera_from_enu = state.camera_from_enu.toRotationMatrix();
  const Vector3d in_camera = camera_from_enu * (enu_from_landmark.translation - state.place);
  SightingJacobian jacobian;
  jacobian.by_state << Matrix3d::Identity(), Matrix3d::Zero(), -CrossProductMatrix(in_camera), -camera_from_enu;
  jacobian.by_landmark << camera_from_enu, Matrix3d::Zero(), Matrix3d::Zero(), camera_from_enu;
  return jacobian;
}

Matrix6 PredictionCovariance(const SightingJacobian& jacobian, const Matrix6& of_state, const Matrix6& of_landmark) {
  return jacobian.by_state * of_state * jacobian.by_state.transpose() +
         jacobian.by_landmark * of_landmark * jacobian.by_landmark.transpose();
}

// (W^-1 + S)^-1 = W - W (W + S^-1)^-1 W, which does not need the inverse of W.
double NormalisedInnovationSquared(const Vector6& error, const Matrix6& information,
                                   const Matrix6& expected_covariance) {
  const auto expected = InvertCovariance(expected_covariance);
  if (!expected) return std::numeric_limits<double>::infinity();
  const Vector6 pulled = information * error;
  return std::max(0.0, error.dot(pulled) - SquaredMahalanobis(pulled, information + *expected));
}

double CountObservedDimensions(const Matrix6& information) {
  return static_cast<double>((information.diagonal().array() > 0).count());
}

std::optional<SmoothedFlight> SmoothFlight(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                                           std::span<const SightingConstraint> constraints,
                                           std::vector<FlightState> start) {
  const Smoother smoother(flight, landmarks, constraints);
  Estimate estimate{std::move(start), {}};
  for (const FlightLandmark& landmark : landmarks) estimate.landmarks.push_back(landmark.enu_from_landmark);
  double damping = 1e-6;
  for (int step = 0; step < kMaxSteps; ++step) {
    BorderedSystem system = smoother.EmptySystem();
    const double cost = smoother.Evaluate(estimate, &system);
    double gain = 0;
    for (; damping < kMaxDamping; damping *= 10) {
      const auto solution = system.Solve(damping);
      if (!solution) continue;
      Estimate moved = smoother.ApplyStep(estimate, *solution);
      gain = cost - smoother.Evaluate(moved, nullptr);
      if (!(gain >= 0)) continue;
      estimate = std::move(moved);
      break;
    }
    if (!(gain > kTolerance)) break;
    damping = std::max(1e-9, damping / 100);
  }
  BorderedSystem system = smoother.EmptySystem();
  const double cost = smoother.Evaluate(estimate, &system);
  auto covariances = system.Invert();
  if (!covariances) return std::nullopt;
  return SmoothedFlight{std::move(estimate.states), std::move(estimate.landmarks), *std::move(covariances), cost};
}

}  // namespace victorious
