#include "victorious/place/navigate/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/place/navigate/covariance.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Two hypotheses agree below this squared Mahalanobis distance: 99.9 % of the chi-square distribution with 6 degrees of
// freedom.
constexpr double kHypothesisGate = 22.46;

// Weight of a landmark's log number of sightings against the log-likelihood of telemetry: two landmarks that agree
// outvote telemetry, one does not (ADR 0011). Chosen, not fitted.
constexpr double kLandmarkWeight = 3;

// The best hypothesis is clear if no other outside its gate has a score within this (log-likelihood). Chosen.
constexpr double kMinScoreMargin = 1;

// About the number of hypotheses of a window that are tried: bounds the cost, which grows with its square.
constexpr std::size_t kMaxHypotheses = 120;

// The transfer of a hypothesis within a window adds a standard deviation of at most kMaxHypothesisSigma_m over this.
constexpr double kTransferRatio = 3;

// Minimum drift of telemetry for the length of a window, m: the window stays finite.
constexpr double kMinWindowDrift_m = 1e-6;

// A pose hypothesis relative to telemetry's pose of the same frame: so hypotheses of different frames are comparable.
struct RelativeHypothesis {
  std::size_t sighting = 0;
  std::size_t landmark = 0;
  double time_s = 0;
  Quaterniond offset;  // of enu_from_camera
  Vector3d place;
  Matrix6 covariance;
  double place_variance = 0;  // sum over the axes
};

// The variance that the transfer of a hypothesis from one frame to another adds.
class PropagationModel {
 public:
  explicit PropagationModel(const FlightInput& flight) : flight_(flight) {}

  [[nodiscard]] Vector6 Variance(std::size_t frame, std::size_t other) const {
    const double dt = std::abs(flight_.frames[frame].time_s - flight_.frames[other].time_s);
    const FlightSigmas& sigmas = flight_.sigmas;
    double turn = std::pow(sigmas.angular_rate_rad_s * dt, 2);
    double move = std::pow(sigmas.speed_m_s * dt, 2);
    const auto& measured = flight_.frames[frame].measured;
    const auto& other_measured = flight_.frames[other].measured;
    if (measured && other_measured) {
      turn = std::min(turn, dt * std::pow(sigmas.drift_attitude_rad, 2)) +
             std::pow(std::max(measured->sigma_attitude_rad, other_measured->sigma_attitude_rad), 2) * 2;
      move = std::min(move, dt * std::pow(sigmas.drift_position_m, 2)) +
             std::pow(std::max(measured->sigma_position_m, other_measured->sigma_position_m), 2) * 2;
    }
    return (Vector6() << turn, turn, turn, move, move, move).finished();
  }

  /// The longest window in which the added variance stays small relative to that of a hypothesis.
  [[nodiscard]] double WindowS() const {
    constexpr double kAllowed_m = kMaxHypothesisSigma_m / kTransferRatio;
    const double by_motion = kAllowed_m / flight_.sigmas.speed_m_s;
    if (!flight_.has_telemetry) return by_motion;
    return std::max(by_motion, std::pow(kAllowed_m / std::max(kMinWindowDrift_m, flight_.sigmas.drift_position_m), 2));
  }

  [[nodiscard]] RelativeHypothesis MakeRelative(const LandmarkSighting& sighting, std::size_t number,
                                                std::size_t landmark, const PoseHypothesis& hypothesis) const {
    const FlightFrame& frame = flight_.frames[sighting.frame];
    RelativeHypothesis node{number,
                            landmark,
                            frame.time_s,
                            hypothesis.camera_from_enu.conjugate(),
                            hypothesis.place,
                            hypothesis.covariance,
                            hypothesis.covariance.bottomRightCorner<3, 3>().trace()};
    if (frame.measured) {
      node.offset = node.offset * frame.measured->CorrectedCameraFromEnu(Vector3d::Zero());
      node.place -= frame.measured->place;
    }
    return node;
  }

  /// The state of a frame according to a hypothesis of that frame, or of another frame if both have telemetry.
  [[nodiscard]] FlightState StateAt(std::size_t frame, const RelativeHypothesis& node) const {
    FlightState state;
    state.place = node.place;
    state.camera_from_enu = node.offset.conjugate();
    if (flight_.frames[frame].measured) {
      const TelemetryPose& measured = *flight_.frames[frame].measured;
      state.place += measured.place;
      state.place_offset = -node.place;
      state.camera_from_enu = measured.CorrectedCameraFromEnu(Vector3d::Zero()) * state.camera_from_enu;
      const Attitude attitude = AttitudeFromRotation(state.camera_from_enu * measured.local_from_enu.conjugate());
      state.attitude_offset << WrapAngle(measured.attitude.yaw_rad - attitude.yaw_rad),
          measured.attitude.pitch_rad - attitude.pitch_rad, WrapAngle(measured.attitude.roll_rad - attitude.roll_rad);
    }
    return state;
  }

 private:
  const FlightInput& flight_;
};

// The comparable hypotheses of one time window.
class HypothesisWindow {
 public:
  HypothesisWindow(const FlightInput& flight, std::span<const LandmarkSighting> sightings,
                   const PropagationModel& propagation)
      : flight_(flight), sightings_(sightings), propagation_(propagation) {}

  /// Ordered by time; those of one sighting are adjacent.
  std::vector<RelativeHypothesis> nodes;

  /// The hypothesis with the highest score, and the nodes that agree with it.
  struct ConsensusSet {
    std::optional<std::size_t> reference;
    std::vector<std::size_t> inliers;
    double score = 0;
    bool clear = false;  // no hypothesis outside the best one's gate has nearly the same score
  };

  [[nodiscard]] ConsensusSet FindConsensus(const std::vector<bool>& wrong) const {
    ConsensusSet best;
    std::vector<std::pair<double, std::size_t>> scores;  // of all hypotheses tried
    for (const std::size_t reference : SampledHypotheses()) {
      if (wrong[nodes[reference].landmark]) continue;
      const double offset = TelemetryDistance(nodes[reference]);
      ConsensusSet consensus{.reference = reference, .inliers = {}, .score = TelemetryLogLikelihood(offset)};
      std::map<std::size_t, int> seen;  // number of sightings per landmark
      std::size_t n = 0;
      while (n < nodes.size()) {  // each sighting supports through its best-fitting landmark
        const std::size_t sighting = nodes[n].sighting;
        double nearest = kHypothesisGate;
        std::optional<std::size_t> inlier;
        for (; n < nodes.size() && nodes[n].sighting == sighting; ++n) {
          if (wrong[nodes[n].landmark]) continue;
          const double distance = HypothesisDistance(nodes[reference], nodes[n]);
          if (distance >= nearest) continue;
          nearest = distance;
          inlier = n;
        }
        if (!inlier) continue;
        consensus.inliers.push_back(*inlier);
        seen[nodes[*inlier].landmark] += 1;
      }
      if (seen.size() == 1 && offset > kHypothesisGate) continue;  // a single landmark does not outvote telemetry
      for (const auto& [landmark, count] : seen) consensus.score += kLandmarkWeight * std::log1p(count);
      scores.emplace_back(consensus.score, reference);
      if (!best.reference || consensus.score > best.score) best = std::move(consensus);
    }
    best.clear = std::ranges::none_of(scores, [&](const auto& other) {
      return other.first > best.score - kMinScoreMargin &&
             HypothesisDistance(nodes[*best.reference], nodes[other.second]) > kHypothesisGate;
    });
    return best;
  }

 private:
  // Student's t distribution of 6 components: large telemetry errors are rare, but possible.
  [[nodiscard]] static double TelemetryLogLikelihood(double squared_distance) {
    constexpr double kComponents = 6;
    return -(kStudentDegreesOfFreedom + kComponents) / 2 * std::log1p(squared_distance / kStudentDegreesOfFreedom);
  }

  // A subset of the hypotheses, spread over the window: all hypotheses of every n-th sighting, so that no landmark is
  // omitted.
  [[nodiscard]] std::vector<std::size_t> SampledHypotheses() const {
    const std::size_t stride = nodes.size() / kMaxHypotheses + 1;
    std::vector<std::size_t> sampled;
    std::size_t sightings = 0;
    for (std::size_t n = 0; n < nodes.size();) {
      const std::size_t sighting = nodes[n].sighting;
      const bool is_sampled = sightings++ % stride == 0;
      for (; n < nodes.size() && nodes[n].sighting == sighting; ++n) {
        if (is_sampled) sampled.push_back(n);
      }
    }
    return sampled;
  }

  // The squared Mahalanobis distance of two hypotheses; infinity if certainly outside the gate.
  [[nodiscard]] double HypothesisDistance(const RelativeHypothesis& a, const RelativeHypothesis& b) const {
    const Vector6 added_variance = propagation_.Variance(sightings_[a.sighting].frame, sightings_[b.sighting].frame);
    // A lower bound of the Mahalanobis distance: the translation alone, with the variance of its widest axis bounded by
    // the trace.
    const double widest = a.place_variance + b.place_variance + added_variance.tail<3>().sum();
    if ((a.place - b.place).squaredNorm() > kHypothesisGate * widest) return std::numeric_limits<double>::infinity();
    Vector6 difference;
    difference << VectorFromRotation(a.offset * b.offset.conjugate()), a.place - b.place;
    Matrix6 covariance = a.covariance + b.covariance;
    covariance.diagonal() += added_variance;
    return SquaredMahalanobis(difference, covariance);
  }

  // The squared Mahalanobis distance from telemetry.
  [[nodiscard]] double TelemetryDistance(const RelativeHypothesis& node) const {
    if (!flight_.frames[sightings_[node.sighting].frame].measured) return 0;
    Vector6 difference;
    difference << VectorFromRotation(node.offset), node.place;
    const FlightSigmas& sigmas = flight_.sigmas;
    const double elapsed_s = node.time_s - flight_.frames.front().time_s;
    Matrix6 covariance = node.covariance;
    covariance.topLeftCorner<3, 3>().diagonal().array() +=
        std::pow(sigmas.offset_attitude_rad, 2) + elapsed_s * std::pow(sigmas.drift_attitude_rad, 2);
    covariance.bottomRightCorner<3, 3>().diagonal().array() +=
        std::pow(sigmas.offset_position_m, 2) + elapsed_s * std::pow(sigmas.drift_position_m, 2);
    return SquaredMahalanobis(difference, covariance);
  }

  const FlightInput& flight_;
  std::span<const LandmarkSighting> sightings_;
  const PropagationModel& propagation_;
};

// Interpolates between frames of known pose: the place linearly, the attitude by slerp; extrapolates as constant.
void FillGaps(const FlightInput& flight, const std::vector<bool>& known, std::vector<FlightState>& states) {
  std::optional<std::size_t> before;
  for (std::size_t k = 0; k <= states.size(); ++k) {
    if (k < states.size() && !known[k]) continue;
    for (std::size_t gap = before ? *before + 1 : 0; gap < k; ++gap) {
      if (!before && k == states.size()) return;
      if (!before || k == states.size()) {
        states[gap] = states[before ? *before : k];
        continue;
      }
      const double whole_s = flight.frames[k].time_s - flight.frames[*before].time_s;
      const double fraction = (flight.frames[gap].time_s - flight.frames[*before].time_s) / whole_s;
      states[gap].place = (1 - fraction) * states[*before].place + fraction * states[k].place;
      states[gap].camera_from_enu = states[*before].camera_from_enu.slerp(fraction, states[k].camera_from_enu);
      states[gap].place_offset = states[*before].place_offset;
      states[gap].attitude_offset = states[*before].attitude_offset;
    }
    before = k;
  }
}

}  // namespace

PoseHypothesis PoseFromSighting(const LandmarkSighting& sighting, const FlightLandmark& landmark) {
  const Rigid3& seen = sighting.camera_from_landmark;
  const Rigid3& known = landmark.enu_from_landmark;
  const Rigid3 enu_from_camera = known * seen.Inverse();
  const Matrix3d rotation = enu_from_camera.rotation.toRotationMatrix();
  const Vector3d to_landmark = rotation * seen.translation;

  Matrix6 by_seen;
  by_seen << -rotation, Matrix3d::Zero(), -rotation * CrossProductMatrix(seen.translation), -rotation;
  Matrix6 by_known;
  by_known << Matrix3d::Identity(), Matrix3d::Zero(), CrossProductMatrix(to_landmark), Matrix3d::Identity();
  return {enu_from_camera.rotation.conjugate(), enu_from_camera.translation,
          by_seen * CovarianceFromInformation(sighting.information) * by_seen.transpose() +
              by_known * landmark.prior_covariance * by_known.transpose()};
}

std::vector<std::optional<std::size_t>> FindConsensusAssociation(const FlightInput& flight,
                                                                 std::span<const FlightLandmark> landmarks,
                                                                 std::span<const LandmarkSighting> sightings,
                                                                 const Candidates& candidates,
                                                                 const std::vector<bool>& wrong) {
  const PropagationModel propagation(flight);
  std::vector<std::optional<std::size_t>> landmark_by_sighting(sightings.size());
  HypothesisWindow window(flight, sightings, propagation);
  const auto resolve_window = [&] {
    const HypothesisWindow::ConsensusSet consensus = window.FindConsensus(wrong);
    if (flight.has_telemetry || consensus.clear) {
      for (const std::size_t n : consensus.inliers) {
        landmark_by_sighting[window.nodes[n].sighting] = window.nodes[n].landmark;
      }
    } else {
      // Ambiguous: accept the sightings with a single candidate landmark, and leave the others until more is known.
      for (const RelativeHypothesis& node : window.nodes) {
        if (candidates.LandmarksFor(node.sighting).size() == 1 && !wrong[node.landmark]) {
          landmark_by_sighting[node.sighting] = node.landmark;
        }
      }
    }
    window.nodes.clear();
  };
  const double window_s = propagation.WindowS();
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const double time_s = flight.frames[sightings[i].frame].time_s;
    // Only the hypotheses of one window are held in memory.
    if (!window.nodes.empty() && time_s - window.nodes.front().time_s > window_s) resolve_window();
    for (const std::size_t landmark : candidates.LandmarksFor(i)) {
      const RelativeHypothesis node =
          propagation.MakeRelative(sightings[i], i, landmark, PoseFromSighting(sightings[i], landmarks[landmark]));
      if (std::sqrt(node.place_variance / 3) <= kMaxHypothesisSigma_m) window.nodes.push_back(node);
    }
  }
  resolve_window();
  return landmark_by_sighting;
}

std::vector<FlightState> EstimateInitialStates(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                                               std::span<const LandmarkSighting> sightings,
                                               std::span<const std::optional<std::size_t>> landmark_by_sighting) {
  const PropagationModel propagation(flight);
  // The most accurate hypothesis of each frame that has one.
  std::map<std::size_t, RelativeHypothesis> best;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (!landmark_by_sighting[i]) continue;
    const RelativeHypothesis node = propagation.MakeRelative(
        sightings[i], i, *landmark_by_sighting[i], PoseFromSighting(sightings[i], landmarks[*landmark_by_sighting[i]]));
    const auto [at, is_new] = best.emplace(sightings[i].frame, node);
    if (!is_new && node.covariance.trace() < at->second.covariance.trace()) at->second = node;
  }
  std::vector<FlightState> states(flight.frames.size());
  std::vector<bool> known(flight.frames.size(), false);
  const RelativeHypothesis zero_offset{
      .offset = Quaterniond::Identity(), .place = Vector3d::Zero(), .covariance = Matrix6::Zero()};
  for (std::size_t k = 0; k < flight.frames.size(); ++k) {
    if (const auto own = best.find(k); own != best.end()) {
      states[k] = propagation.StateAt(k, own->second);
      known[k] = true;
    } else if (flight.frames[k].measured) {
      // Telemetry, corrected by the offset of the nearest frame with a hypothesis.
      const RelativeHypothesis* nearest = &zero_offset;
      double apart_s = std::numeric_limits<double>::infinity();
      auto after = best.lower_bound(k);
      for (const int way : {0, 1}) {
        if (way == 0 ? after == best.end() : after == best.begin()) continue;
        const auto& [frame, node] = way == 0 ? *after : *std::prev(after);
        const double off_s = std::abs(flight.frames[frame].time_s - flight.frames[k].time_s);
        if (!flight.frames[frame].measured || off_s >= apart_s) continue;
        apart_s = off_s;
        nearest = &node;
      }
      states[k] = propagation.StateAt(k, *nearest);
      known[k] = true;
    }
  }
  FillGaps(flight, known, states);
  return states;
}

}  // namespace victorious
