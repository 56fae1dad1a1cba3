#include "victorious/place/navigate/candidates.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "victorious/place/navigate/covariance.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// Minimum number of candidates, however large the telemetry error. Chosen: their number bounds the cost of a sighting.
constexpr std::size_t kMinCandidates = 16;

double Squared(double value) { return value * value; }

// The position of the observed object predicted by telemetry, and the sum of the variances along the axes.
struct Prediction {
  Vector3d place;
  double variance_m2 = 0;
};

Prediction PredictPosition(const FlightInput& flight, std::size_t measured_frame, const LandmarkSighting& sighting) {
  const FlightSigmas& sigmas = flight.sigmas;
  const FlightFrame& frame = flight.frames[measured_frame];
  const double walked_s = frame.time_s - flight.frames.front().time_s;
  const double apart_s = std::abs(flight.frames[sighting.frame].time_s - frame.time_s);
  const Vector3d& seen = sighting.camera_from_landmark.translation;
  const double position_variance_m2 = Squared(sigmas.offset_position_m) + walked_s * Squared(sigmas.drift_position_m) +
                                      Squared(frame.measured->sigma_position_m) + Squared(sigmas.speed_m_s * apart_s);
  const double attitude_variance_rad2 =
      Squared(sigmas.offset_attitude_rad) + walked_s * Squared(sigmas.drift_attitude_rad) +
      Squared(frame.measured->sigma_attitude_rad) + Squared(sigmas.angular_rate_rad_s * apart_s);
  return {frame.measured->place + frame.measured->CorrectedCameraFromEnu(Vector3d::Zero()).conjugate() * seen,
          3 * position_variance_m2 + 2 * seen.squaredNorm() * attitude_variance_rad2 +
              CovarianceFromInformation(sighting.information).bottomRightCorner<3, 3>().trace()};
}

std::vector<std::size_t> NearbyLandmarks(const Prediction& predicted, std::span<const FlightLandmark> landmarks,
                                         std::span<const std::size_t> model_landmarks, double gate_sigma) {
  std::vector<std::pair<double, std::size_t>> off;  // squared distance relative to the gate
  for (const std::size_t landmark : model_landmarks) {
    const Matrix6& prior = landmarks[landmark].prior_covariance;
    const double variance_m2 = predicted.variance_m2 + prior.bottomRightCorner<3, 3>().trace();
    const double squared_m2 = (landmarks[landmark].enu_from_landmark.translation - predicted.place).squaredNorm();
    off.emplace_back(squared_m2 / (gate_sigma * gate_sigma * variance_m2), landmark);
  }
  const auto rest = off.begin() + static_cast<std::ptrdiff_t>(kMinCandidates);
  std::ranges::nth_element(off, rest);
  off.erase(std::remove_if(rest, off.end(), [](const auto& one) { return !(one.first <= 1); }), off.end());
  std::vector<std::size_t> nearby;
  for (const auto& [normalised_distance, landmark] : off) nearby.push_back(landmark);
  std::ranges::sort(nearby);
  return nearby;
}

}  // namespace

Candidates::Candidates(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                       std::span<const std::vector<std::size_t>> landmarks_by_model,
                       std::span<const LandmarkSighting> sightings, const NavigateOptions& options)
    : landmarks_by_model_(landmarks_by_model), nearby_(sightings.size()) {
  for (const LandmarkSighting& sighting : sightings) sighting_models_.push_back(sighting.model);
  std::vector<std::size_t> measured;  // frames with telemetry
  for (std::size_t k = 0; k < flight.frames.size(); ++k) {
    if (flight.frames[k].measured) measured.push_back(k);
  }
  if (measured.empty()) return;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const std::vector<std::size_t>& model_landmarks = landmarks_by_model[sightings[i].model];
    if (model_landmarks.size() <= kMinCandidates) continue;
    const auto time_of = [&](std::size_t frame) { return flight.frames[frame].time_s; };
    auto nearest = std::ranges::lower_bound(measured, sightings[i].frame);
    if (nearest == measured.end()) --nearest;
    if (nearest != measured.begin()) {
      const auto before = std::prev(nearest);
      const double time_s = time_of(sightings[i].frame);
      if (std::abs(time_of(*before) - time_s) < std::abs(time_of(*nearest) - time_s)) nearest = before;
    }
    nearby_[i] = NearbyLandmarks(PredictPosition(flight, *nearest, sightings[i]), landmarks, model_landmarks,
                                 options.gate_sigma);
  }
}

}  // namespace victorious
