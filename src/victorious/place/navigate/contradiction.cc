#include "victorious/place/navigate/contradiction.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "victorious/place/navigate/agreement.h"

namespace victorious {
namespace {

using SightingIndices = std::vector<std::size_t>;  // indices of sightings

// Margin before and after a landmark is in view, s, in which the flight is still known to some degree: after 3 s the
// motion model's standard deviation of the place, 5 m/s sqrt(t^3 / 3), is kMaxHypothesisSigma_m.
constexpr double kMargin_s = 4;

// Number of another landmark's sightings that vote, those nearest in time: odd, and few enough that all are near.
constexpr std::size_t kNumTested = 7;

// An agreement counts only where the standard deviation of the place is below kMaxHypothesisSigma_m by this factor.
constexpr double kSignificance = 3;

// The flight while one landmark is in view, estimated from only that landmark.
class SingleLandmarkFlight {
 public:
  SingleLandmarkFlight(const FlightInput& flight, const FlightLandmark& landmark,
                       std::span<const LandmarkSighting> sightings, const SightingIndices& own) {
    const double begin_s = flight.frames[sightings[own.front()].frame].time_s - kMargin_s;
    const double end_s = flight.frames[sightings[own.back()].frame].time_s + kMargin_s;
    const auto first = std::ranges::lower_bound(flight.frames, begin_s, {}, &FlightFrame::time_s);
    const auto last = std::ranges::upper_bound(flight.frames, end_s, {}, &FlightFrame::time_s);
    first_ = static_cast<std::size_t>(first - flight.frames.begin());
    FlightInput part{.frames = {first, last}, .sigmas = flight.sigmas, .has_telemetry = flight.has_telemetry};
    std::vector<LandmarkSighting> seen;
    std::vector<SightingConstraint> constraints;
    for (const std::size_t i : own) {
      seen.push_back(sightings[i]);
      seen.back().frame -= first_;
      constraints.push_back({seen.back().frame, 0, sightings[i].camera_from_landmark, sightings[i].information});
    }
    const std::vector<FlightLandmark> landmarks = {landmark};
    const std::vector<std::optional<std::size_t>> all(seen.size(), 0);
    smoothed_ = SmoothFlight(part, landmarks, constraints, EstimateInitialStates(part, landmarks, seen, all));
  }

  [[nodiscard]] double cost() const { return smoothed_ ? smoothed_->cost : 0; }

  struct Distance {
    double squared = 0;  // in sigmas
    double sigma_m = 0;  // of the estimated place in that frame
  };

  /// The squared innovation of a sighting, if it is of this landmark; std::nullopt if the flight is not accurate enough
  /// there.
  [[nodiscard]] std::optional<Distance> InnovationTo(const LandmarkSighting& sighting,
                                                     const FlightLandmark& landmark) const {
    if (!smoothed_ || sighting.frame < first_ || sighting.frame - first_ >= smoothed_->states.size()) {
      return std::nullopt;
    }
    const std::size_t frame = sighting.frame - first_;
    const Matrix6 of_state = smoothed_->covariances.blocks[frame].topLeftCorner<6, 6>();
    const double sigma_m = std::sqrt(of_state.bottomRightCorner<3, 3>().trace() / 3);
    if (sigma_m > kMaxHypothesisSigma_m) return std::nullopt;
    const FlightState& state = smoothed_->states[frame];
    const SightingJacobian jacobian = ComputeSightingJacobian(state, landmark.enu_from_landmark);
    const Matrix6 expected = PredictionCovariance(jacobian, of_state, landmark.prior_covariance);
    const Vector6 error = SightingError(sighting.camera_from_landmark, state, landmark.enu_from_landmark);
    return Distance{NormalisedInnovationSquared(error, sighting.information, expected), sigma_m};
  }

 private:
  std::size_t first_ = 0;
  std::optional<SmoothedFlight> smoothed_;
};

// For each pair of landmarks: 1 consistent, -1 contradictory, 0 unknown.
using PairConsistency = std::map<std::pair<std::size_t, std::size_t>, int>;

// Tests another landmark's sightings against one landmark's flight: a vote of those nearest in time.
int TestConsistency(const SingleLandmarkFlight& single_flight, std::span<const LandmarkSighting> sightings,
                    const SightingIndices& own, const SightingIndices& others, const FlightLandmark& other,
                    const NavigateOptions& options) {
  const auto frame_of = [&](std::size_t i) { return sightings[i].frame; };
  std::vector<std::pair<std::size_t, std::size_t>> nearest;  // distance in frames, sighting
  for (const std::size_t i : others) {
    const std::size_t frame = sightings[i].frame;
    const auto after = std::ranges::lower_bound(own, frame, {}, frame_of);
    std::size_t apart = std::numeric_limits<std::size_t>::max();
    if (after != own.end()) apart = frame_of(*after) - frame;
    if (after != own.begin()) apart = std::min(apart, frame - frame_of(*std::prev(after)));
    nearest.emplace_back(apart, i);
  }
  std::ranges::sort(nearest);
  nearest.resize(std::min(nearest.size(), kNumTested));
  int sum = 0;
  for (const auto& [apart, i] : nearest) {
    const auto distance = single_flight.InnovationTo(sightings[i], other);
    if (!distance) continue;
    // Agreement under a large uncertainty is not significant.
    const bool agrees = distance->squared < options.gate_sigma * options.gate_sigma;
    if (!agrees || distance->sigma_m < kMaxHypothesisSigma_m / kSignificance) sum += agrees ? 1 : -1;
  }
  return (sum > 0) - (sum < 0);
}

// The cost of a flight by all landmarks that are not wrong, minus the costs of their separate flights: their
// inconsistency.
double InconsistencyCost(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                         std::span<const LandmarkSighting> sightings,
                         std::span<const std::optional<std::size_t>> landmark_by_sighting,
                         const std::vector<bool>& wrong, const std::map<std::size_t, double>& separate_costs) {
  std::vector<std::optional<std::size_t>> kept(landmark_by_sighting.begin(), landmark_by_sighting.end());
  std::map<std::size_t, std::size_t> used_as;
  std::vector<FlightLandmark> used;
  std::vector<SightingConstraint> constraints;
  double inconsistency = 0;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (kept[i] && wrong[*kept[i]]) kept[i].reset();
    if (!kept[i]) continue;
    const auto [at, is_new] = used_as.emplace(*kept[i], used.size());
    if (is_new) {
      used.push_back(landmarks[*kept[i]]);
      inconsistency -= separate_costs.at(*kept[i]);
    }
    constraints.push_back(
        {sightings[i].frame, at->second, sightings[i].camera_from_landmark, sightings[i].information});
  }
  const auto smoothed =
      SmoothFlight(flight, used, constraints, EstimateInitialStates(flight, landmarks, sightings, kept));
  return smoothed ? inconsistency + smoothed->cost : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<bool> FindContradictions(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                                     std::span<const LandmarkSighting> sightings,
                                     std::span<const std::optional<std::size_t>> landmark_by_sighting,
                                     const NavigateOptions& options) {
  std::map<std::size_t, SightingIndices> seen;  // by landmark
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (landmark_by_sighting[i]) seen[*landmark_by_sighting[i]].push_back(i);
  }
  PairConsistency pair_consistency;
  std::map<std::size_t, double> separate_costs;  // cost of each landmark's separate flight
  for (const auto& [one, own] : seen) {
    const SingleLandmarkFlight single_flight(flight, landmarks[one], sightings, own);
    separate_costs[one] = single_flight.cost();
    for (const auto& [other, others] : seen) {
      if (other == one) continue;
      // Test in both directions: a known result overrides an unknown one, and a contradiction overrides an agreement.
      int& consistency = pair_consistency[std::minmax(one, other)];
      const int result = TestConsistency(single_flight, sightings, own, others, landmarks[other], options);
      consistency = consistency < 0 || result < 0 ? -1 : std::max(consistency, result);
    }
  }
  std::vector<bool> wrong(landmarks.size(), false);
  while (true) {
    std::map<std::size_t, int> contradiction_balance;  // contradictions minus agreements
    std::vector<std::size_t> contradicted;
    for (const auto& [pair, consistency] : pair_consistency) {
      if (wrong[pair.first] || wrong[pair.second]) continue;
      contradiction_balance[pair.first] -= consistency;
      contradiction_balance[pair.second] -= consistency;
      if (consistency < 0) contradicted.insert(contradicted.end(), {pair.first, pair.second});
    }
    if (contradicted.empty()) return wrong;
    int max_balance = std::numeric_limits<int>::min();
    for (const std::size_t landmark : contradicted)
      max_balance = std::max(max_balance, contradiction_balance[landmark]);
    std::ranges::sort(contradicted);
    contradicted.erase(std::unique(contradicted.begin(), contradicted.end()), contradicted.end());
    std::erase_if(contradicted, [&](std::size_t landmark) { return contradiction_balance[landmark] < max_balance; });
    std::size_t worst = contradicted.front();
    if (contradicted.size() > 1) {
      double min_inconsistency = std::numeric_limits<double>::infinity();
      for (const std::size_t landmark : contradicted) {
        std::vector<bool> without = wrong;
        without[landmark] = true;
        const double inconsistency =
            InconsistencyCost(flight, landmarks, sightings, landmark_by_sighting, without, separate_costs);
        if (inconsistency >= min_inconsistency) continue;
        min_inconsistency = inconsistency;
        worst = landmark;
      }
    }
    wrong[worst] = true;
  }
}

}  // namespace victorious
