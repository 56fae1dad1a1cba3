#include "victorious/navigate/smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/navigate/covariance.h"

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
constexpr Index kTurnRate = 6;
constexpr Index kVelocity = 9;
constexpr Index kPlaceOffset = 12;
constexpr Index kAttitudeOffset = 15;
constexpr Index kWithoutOffsets = 12;
constexpr Index kWithOffsets = 18;

constexpr double kStudentFreedom = 6;

double InverseSquare(double sigma) { return 1 / (sigma * sigma); }

// Robust error model, a t distribution of `count` residuals whose normalised squares sum to `squared`: the negative
// log-likelihood, and the weight relative to a normal distribution.
struct Student {
  Student(double squared, double count)
      : cost(0.5 * (kStudentFreedom + count) * std::log1p(squared / kStudentFreedom)),
        weight((kStudentFreedom + count) / (kStudentFreedom + squared)) {}

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
  fill(kTurn, kTurnRate, sigmas.turn_change_rad_s);
  fill(kPlace, kVelocity, sigmas.speed_change_m_s);
  return information;
}

class Smoother {
 public:
  Smoother(const Flight& flight, std::span<const FlightLandmark> landmarks, std::span<const FlightTie> ties)
      : flight_(flight), landmarks_(landmarks), ties_(ties) {
    for (const FlightLandmark& landmark : landmarks) {
      // A singular prior adds no information.
      landmark_information_.push_back(InverseOf(landmark.prior_covariance).value_or(Matrix6::Zero()));
    }
  }

  /// The negative log-likelihood of the estimate. Adds its normal equations to `system`, if given.
  double Weigh(const Estimate& estimate, BorderedSystem* system) const {
    double cost = WeighFirst(estimate, system);
    for (std::size_t k = 0; k < flight_.frames.size(); ++k) {
      if (k > 0) cost += WeighMotion(estimate, k - 1, system);
      if (flight_.frames[k].told) cost += WeighTold(estimate, k, system);
    }
    for (std::size_t i = 0; i < landmarks_.size(); ++i) cost += WeighLandmark(estimate, i, system);
    for (const FlightTie& tie : ties_) cost += WeighTie(estimate, tie, system);
    return cost;
  }

  [[nodiscard]] BorderedSystem EmptySystem() const {
    return {flight_.frames.size(), flight_.has_told ? kWithOffsets : kWithoutOffsets,
            6 * static_cast<Index>(landmarks_.size())};
  }

  [[nodiscard]] Estimate Moved(const Estimate& estimate, const BorderedSystem::Solution& step) const {
    Estimate moved = estimate;
    for (std::size_t k = 0; k < moved.states.size(); ++k) {
      const Eigen::VectorXd& change = step.blocks[k];
      FlightState& state = moved.states[k];
      state.camera_from_enu = (RotationOf(change.segment<3>(kTurn)) * state.camera_from_enu).normalized();
      state.place += change.segment<3>(kPlace);
      state.turn_rate += change.segment<3>(kTurnRate);
      state.velocity += change.segment<3>(kVelocity);
      if (!flight_.has_told) continue;
      state.place_offset += change.segment<3>(kPlaceOffset);
      state.attitude_offset += change.segment<3>(kAttitudeOffset);
    }
    for (std::size_t i = 0; i < moved.landmarks.size(); ++i) {
      const Vector6 change = step.border.segment<6>(6 * static_cast<Index>(i));
      Rigid3& pose = moved.landmarks[i];
      pose.rotation = (RotationOf(change.head<3>()) * pose.rotation).normalized();
      pose.translation += change.tail<3>();
    }
    return moved;
  }

 private:
  // Prior of the first state: wide in the pose; sigmas for the velocities and for the telemetry offset.
  double WeighFirst(const Estimate& estimate, BorderedSystem* system) const {
    const FlightSigmas& sigmas = flight_.sigmas;
    const FlightState& first = estimate.states.front();
    double cost = 0;
    const auto tie = [&](Index at, const Vector3d& value, double sigma) {
      const double weight = InverseSquare(sigma);
      cost += 0.5 * weight * value.squaredNorm();
      if (system == nullptr) return;
      system->diagonal.front().diagonal().segment<3>(at).array() += weight;
      system->right.front().segment<3>(at) -= weight * value;
    };
    constexpr double kAnywhereM = 1e5;
    tie(kTurn, Vector3d::Zero(), kPi);
    tie(kPlace, Vector3d::Zero(), kAnywhereM);
    tie(kTurnRate, first.turn_rate, sigmas.turn_rad_s);
    tie(kVelocity, first.velocity, sigmas.speed_m_s);
    if (!flight_.has_told) return cost;
    // Heavy tails: a telemetry offset far above its sigma does not dominate the estimate.
    const auto tie_offset = [&](Index at, const Vector3d& value, double sigma) {
      const double squared = value.squaredNorm() * InverseSquare(sigma);
      const Student student(squared, 3);
      tie(at, value, sigma / std::sqrt(student.weight));
      cost += student.cost - 0.5 * student.weight * squared;
    };
    tie_offset(kPlaceOffset, first.place_offset, sigmas.offset_position_m);
    tie_offset(kAttitudeOffset, first.attitude_offset, sigmas.offset_attitude_rad);
    return cost;
  }

  // Motion model from frame k to the next.
  double WeighMotion(const Estimate& estimate, std::size_t k, BorderedSystem* system) const {
    constexpr double kLeastStepS = 1e-3;
    const double dt = std::max(kLeastStepS, flight_.frames[k + 1].time_s - flight_.frames[k].time_s);
    const FlightState& now = estimate.states[k];
    const FlightState& next = estimate.states[k + 1];
    const Quaterniond turn = RotationOf(now.turn_rate * dt);
    Vector12 off;
    off << VectorOf(next.camera_from_enu * (turn * now.camera_from_enu).conjugate()),
        next.place - now.place - dt * now.velocity, next.turn_rate - now.turn_rate, next.velocity - now.velocity;
    const Matrix12 information = MotionInformation(dt, flight_.sigmas);
    double cost = 0.5 * off.dot(information * off);
    if (system != nullptr) {
      Matrix12 by_now = -Matrix12::Identity();
      by_now.block<3, 3>(kTurn, kTurn) = -turn.toRotationMatrix();
      by_now.block<3, 3>(kTurn, kTurnRate) = -dt * Matrix3d::Identity();
      by_now.block<3, 3>(kPlace, kVelocity) = -dt * Matrix3d::Identity();
      const Matrix12 weighted = by_now.transpose() * information;  // by_next is the identity
      system->diagonal[k].topLeftCorner<12, 12>() += weighted * by_now;
      system->diagonal[k + 1].topLeftCorner<12, 12>() += information;
      system->upper[k].topLeftCorner<12, 12>() += weighted;
      system->right[k].head<12>() -= weighted * off;
      system->right[k + 1].head<12>() -= information * off;
    }
    if (!flight_.has_told) return cost;
    const auto walk = [&](Index at, const Vector3d& change, double drift, double least) {
      const double sure = 1 / (dt * std::max(drift * drift, least * least));
      const Student student(sure * change.squaredNorm(), 3);  // telemetry may jump
      const double weight = student.weight * sure;
      cost += student.cost;
      if (system == nullptr) return;
      system->diagonal[k].diagonal().segment<3>(at).array() += weight;
      system->diagonal[k + 1].diagonal().segment<3>(at).array() += weight;
      system->upper[k].diagonal().segment<3>(at).array() -= weight;
      system->right[k].segment<3>(at) += weight * change;
      system->right[k + 1].segment<3>(at) -= weight * change;
    };
    constexpr double kLeastDriftM = 1e-3;  // keeps the system well-conditioned
    constexpr double kLeastDriftRad = 1e-5;
    walk(kPlaceOffset, next.place_offset - now.place_offset, flight_.sigmas.drift_position_m, kLeastDriftM);
    walk(kAttitudeOffset, next.attitude_offset - now.attitude_offset, flight_.sigmas.drift_attitude_rad,
         kLeastDriftRad);
    return cost;
  }

  double WeighTold(const Estimate& estimate, std::size_t k, BorderedSystem* system) const {
    const ToldPose& told = *flight_.frames[k].told;
    const FlightState& state = estimate.states[k];
    const Vector3d place_off = state.place + state.place_offset - told.place;
    const Quaterniond expected = told.CameraFromEnuLess(state.attitude_offset);
    const Vector3d attitude_off = VectorOf(state.camera_from_enu * expected.conjugate());
    const Student of_place(place_off.squaredNorm() * InverseSquare(told.sigma_position_m), 3);
    const Student of_attitude(attitude_off.squaredNorm() * InverseSquare(told.sigma_attitude_rad), 3);
    const double place_weight = of_place.weight * InverseSquare(told.sigma_position_m);
    const double attitude_weight = of_attitude.weight * InverseSquare(told.sigma_attitude_rad);
    const double cost = of_place.cost + of_attitude.cost;
    if (system == nullptr) return cost;
    MatrixXd& block = system->diagonal[k];
    Eigen::VectorXd& right = system->right[k];
    for (const Index at : {kPlace, kPlaceOffset}) {
      block.diagonal().segment<3>(at).array() += place_weight;
      right.segment<3>(at) -= place_weight * place_off;
    }
    block.block<3, 3>(kPlace, kPlaceOffset).diagonal().array() += place_weight;
    block.block<3, 3>(kPlaceOffset, kPlace).diagonal().array() += place_weight;
    Matrix3d by_offset;
    constexpr double kStepRad = 1e-5;
    for (Index axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStepRad * Vector3d::Unit(axis);
      const Quaterniond more = told.CameraFromEnuLess(state.attitude_offset + step);
      by_offset.col(axis) = VectorOf(expected * more.conjugate()) / kStepRad;
    }
    block.block<3, 3>(kTurn, kTurn).diagonal().array() += attitude_weight;
    block.block<3, 3>(kTurn, kAttitudeOffset) += attitude_weight * by_offset;
    block.block<3, 3>(kAttitudeOffset, kTurn) += attitude_weight * by_offset.transpose();
    block.block<3, 3>(kAttitudeOffset, kAttitudeOffset) += attitude_weight * by_offset.transpose() * by_offset;
    right.segment<3>(kTurn) -= attitude_weight * attitude_off;
    right.segment<3>(kAttitudeOffset) -= attitude_weight * by_offset.transpose() * attitude_off;
    return cost;
  }

  double WeighLandmark(const Estimate& estimate, std::size_t i, BorderedSystem* system) const {
    const Rigid3& told = landmarks_[i].enu_from_landmark;
    const Rigid3& now = estimate.landmarks[i];
    Vector6 off;
    off << VectorOf(now.rotation * told.rotation.conjugate()), now.translation - told.translation;
    const Matrix6& information = landmark_information_[i];
    if (system != nullptr) {
      const Index at = 6 * static_cast<Index>(i);
      system->corner.block<6, 6>(at, at) += information;
      system->corner_right.segment<6>(at) -= information * off;
    }
    return 0.5 * off.dot(information * off);
  }

  double WeighTie(const Estimate& estimate, const FlightTie& tie, BorderedSystem* system) const {
    const FlightState& state = estimate.states[tie.frame];
    const Rigid3& landmark = estimate.landmarks[tie.landmark];
    const Vector6 off = SightingError(tie.camera_from_landmark, state, landmark);
    const double squared = off.dot(tie.information * off);
    const Student student(squared, DimensionsOf(tie.information));
    if (system != nullptr) {
      const Matrix6 information = student.weight * tie.information;
      const SightingJacobian jacobian = SightingDerivative(state, landmark);
      const Index at = 6 * static_cast<Index>(tie.landmark);
      const Matrix6 state_weighted = jacobian.by_state.transpose() * information;
      const Matrix6 landmark_weighted = jacobian.by_landmark.transpose() * information;
      system->diagonal[tie.frame].topLeftCorner<6, 6>() += state_weighted * jacobian.by_state;
      BorderedSystem::Part& part = system->border[tie.frame].emplace_back();
      part = {at, MatrixXd::Zero(system->block_size(), 6)};
      part.columns.topRows<6>() = state_weighted * jacobian.by_landmark;
      system->corner.block<6, 6>(at, at) += landmark_weighted * jacobian.by_landmark;
      system->right[tie.frame].head<6>() -= state_weighted * off;
      system->corner_right.segment<6>(at) -= landmark_weighted * off;
    }
    return student.cost;
  }

  const Flight& flight_;
  std::span<const FlightLandmark> landmarks_;
  std::span<const FlightTie> ties_;
  std::vector<Matrix6> landmark_information_;
};

}  // namespace

Quaterniond ToldPose::CameraFromEnuLess(const Vector3d& attitude_offset) const {
  return CameraFromEnu({attitude.yaw_rad - attitude_offset[0], attitude.pitch_rad - attitude_offset[1],
                        attitude.roll_rad - attitude_offset[2]}) *
         local_from_enu;
}

Vector6 SightingError(const Rigid3& seen, const FlightState& state, const Rigid3& enu_from_landmark) {
  const Quaterniond rotation = state.camera_from_enu * enu_from_landmark.rotation;
  Vector6 off;
  off << VectorOf(rotation * seen.rotation.conjugate()),
      state.camera_from_enu * (enu_from_landmark.translation - state.place) - seen.translation;
  return off;
}

SightingJacobian SightingDerivative(const FlightState& state, const Rigid3& enu_from_landmark) {
  const Matrix3d camera_from_enu = state.camera_from_enu.toRotationMatrix();
  const Vector3d in_camera = camera_from_enu * (enu_from_landmark.translation - state.place);
  SightingJacobian jacobian;
  jacobian.by_state << Matrix3d::Identity(), Matrix3d::Zero(), -SkewOf(in_camera), -camera_from_enu;
  jacobian.by_landmark << camera_from_enu, Matrix3d::Zero(), Matrix3d::Zero(), camera_from_enu;
  return jacobian;
}

// (W^-1 + S)^-1 = W - W (W + S^-1)^-1 W, which does not need the inverse of W.
double SquaredDistance(const Vector6& error, const Matrix6& information, const Matrix6& expected_covariance) {
  const auto expected = InverseOf(expected_covariance);
  if (!expected) return std::numeric_limits<double>::infinity();
  const Vector6 pulled = information * error;
  return std::max(0.0, error.dot(pulled) - SquaredSigmas(pulled, information + *expected));
}

double DimensionsOf(const Matrix6& information) {
  return static_cast<double>((information.diagonal().array() > 0).count());
}

std::optional<SmoothedFlight> SmoothFlight(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                           std::span<const FlightTie> ties, std::vector<FlightState> start) {
  constexpr int kMostSteps = 40;
  constexpr double kSettled = 1e-3;  // of a cost that is half a sum of squared normalised residuals
  constexpr double kMostDamping = 1e8;
  const Smoother smoother(flight, landmarks, ties);
  Estimate estimate{std::move(start), {}};
  for (const FlightLandmark& landmark : landmarks) estimate.landmarks.push_back(landmark.enu_from_landmark);
  double damping = 1e-6;
  for (int step = 0; step < kMostSteps; ++step) {
    BorderedSystem system = smoother.EmptySystem();
    const double cost = smoother.Weigh(estimate, &system);
    double gain = 0;
    for (; damping < kMostDamping; damping *= 10) {
      const auto solution = system.Solve(damping);
      if (!solution) continue;
      Estimate moved = smoother.Moved(estimate, *solution);
      gain = cost - smoother.Weigh(moved, nullptr);
      if (!(gain >= 0)) continue;
      estimate = std::move(moved);
      break;
    }
    if (!(gain > kSettled)) break;
    damping = std::max(1e-9, damping / 100);
  }
  BorderedSystem system = smoother.EmptySystem();
  const double cost = smoother.Weigh(estimate, &system);
  auto covariances = system.Invert();
  if (!covariances) return std::nullopt;
  return SmoothedFlight{std::move(estimate.states), std::move(estimate.landmarks), *std::move(covariances), cost};
}

}  // namespace victorious
