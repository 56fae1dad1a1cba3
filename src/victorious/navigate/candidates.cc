#include "victorious/navigate/candidates.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "victorious/navigate/covariance.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFewest = 16;  // minimum number of candidates, however large the telemetry error

double Squared(double value) { return value * value; }

// The position of the observed object predicted by telemetry, and the sum of the variances along the axes.
struct Expected {
  Vector3d place;
  double variance_m2 = 0;
};

Expected ExpectedOf(const Flight& flight, std::size_t told_frame, const LandmarkSighting& sighting) {
  const FlightSigmas& sigmas = flight.sigmas;
  const FlightFrame& frame = flight.frames[told_frame];
  const double walked_s = frame.time_s - flight.frames.front().time_s;
  const double apart_s = std::abs(flight.frames[sighting.frame].time_s - frame.time_s);
  const Vector3d& seen = sighting.camera_from_landmark.translation;
  const double of_place = Squared(sigmas.offset_position_m) + walked_s * Squared(sigmas.drift_position_m) +
                          Squared(frame.told->sigma_position_m) + Squared(sigmas.speed_m_s * apart_s);
  const double of_attitude = Squared(sigmas.offset_attitude_rad) + walked_s * Squared(sigmas.drift_attitude_rad) +
                             Squared(frame.told->sigma_attitude_rad) + Squared(sigmas.turn_rad_s * apart_s);
  return {frame.told->place + frame.told->CameraFromEnuLess(Vector3d::Zero()).conjugate() * seen,
          3 * of_place + 2 * seen.squaredNorm() * of_attitude +
              CovarianceOf(sighting.information).bottomRightCorner<3, 3>().trace()};
}

std::vector<std::size_t> Near(const Expected& expected, std::span<const FlightLandmark> landmarks,
                              std::span<const std::size_t> of_model, double gate_sigma) {
  std::vector<std::pair<double, std::size_t>> off;  // squared distance relative to the gate
  for (const std::size_t landmark : of_model) {
    const Matrix6& prior = landmarks[landmark].prior_covariance;
    const double variance_m2 = expected.variance_m2 + prior.bottomRightCorner<3, 3>().trace();
    const double squared_m2 = (landmarks[landmark].enu_from_landmark.translation - expected.place).squaredNorm();
    off.emplace_back(squared_m2 / (gate_sigma * gate_sigma * variance_m2), landmark);
  }
  const auto rest = off.begin() + static_cast<std::ptrdiff_t>(kFewest);
  std::ranges::nth_element(off, rest);
  off.erase(std::remove_if(rest, off.end(), [](const auto& one) { return !(one.first <= 1); }), off.end());
  std::vector<std::size_t> near;
  for (const auto& [share, landmark] : off) near.push_back(landmark);
  std::ranges::sort(near);
  return near;
}

}  // namespace

Candidates::Candidates(const Flight& flight, std::span<const FlightLandmark> landmarks,
                       std::span<const std::vector<std::size_t>> landmarks_of,
                       std::span<const LandmarkSighting> sightings, const NavigateOptions& options)
    : landmarks_of_(landmarks_of), near_(sightings.size()) {
  for (const LandmarkSighting& sighting : sightings) model_of_.push_back(sighting.model);
  std::vector<std::size_t> told;  // frames with telemetry
  for (std::size_t k = 0; k < flight.frames.size(); ++k) {
    if (flight.frames[k].told) told.push_back(k);
  }
  if (told.empty()) return;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const std::vector<std::size_t>& of_model = landmarks_of[sightings[i].model];
    if (of_model.size() <= kFewest) continue;
    const auto time_of = [&](std::size_t frame) { return flight.frames[frame].time_s; };
    auto nearest = std::ranges::lower_bound(told, sightings[i].frame);
    if (nearest == told.end()) --nearest;
    if (nearest != told.begin()) {
      const auto before = std::prev(nearest);
      const double time_s = time_of(sightings[i].frame);
      if (std::abs(time_of(*before) - time_s) < std::abs(time_of(*nearest) - time_s)) nearest = before;
    }
    near_[i] = Near(ExpectedOf(flight, *nearest, sightings[i]), landmarks, of_model, options.gate_sigma);
  }
}

}  // namespace victorious
