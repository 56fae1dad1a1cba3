#include "victorious/navigate/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/navigate/covariance.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// A pose hypothesis relative to telemetry's pose of the same frame: so hypotheses of different frames are comparable.
struct Node {
  std::size_t sighting = 0;
  std::size_t landmark = 0;
  double time_s = 0;
  Quaterniond offset;  // of enu_from_camera
  Vector3d place;
  Matrix6 covariance;
  double place_variance = 0;  // sum over the axes
};

// The variance that the transfer of a hypothesis from one frame to another adds.
class Carrier {
 public:
  explicit Carrier(const Flight& flight) : flight_(flight) {}

  [[nodiscard]] Vector6 Variance(std::size_t frame, std::size_t other) const {
    const double dt = std::abs(flight_.frames[frame].time_s - flight_.frames[other].time_s);
    const FlightSigmas& sigmas = flight_.sigmas;
    double turn = std::pow(sigmas.turn_rad_s * dt, 2);
    double move = std::pow(sigmas.speed_m_s * dt, 2);
    const auto& told = flight_.frames[frame].told;
    const auto& other_told = flight_.frames[other].told;
    if (told && other_told) {
      turn = std::min(turn, dt * std::pow(sigmas.drift_attitude_rad, 2)) +
             std::pow(std::max(told->sigma_attitude_rad, other_told->sigma_attitude_rad), 2) * 2;
      move = std::min(move, dt * std::pow(sigmas.drift_position_m, 2)) +
             std::pow(std::max(told->sigma_position_m, other_told->sigma_position_m), 2) * 2;
    }
    return (Vector6() << turn, turn, turn, move, move, move).finished();
  }

  /// The longest window in which the added variance stays small relative to that of a hypothesis.
  [[nodiscard]] double WindowS(double claim_sigma_m) const {
    const double allowed_m = claim_sigma_m / 3;
    const double by_motion = allowed_m / flight_.sigmas.speed_m_s;
    if (!flight_.has_told) return by_motion;
    return std::max(by_motion, std::pow(allowed_m / std::max(1e-6, flight_.sigmas.drift_position_m), 2));
  }

  [[nodiscard]] Node NodeOf(const LandmarkSighting& sighting, std::size_t number, std::size_t landmark,
                            const PoseClaim& claim) const {
    const FlightFrame& frame = flight_.frames[sighting.frame];
    Node node{number,
              landmark,
              frame.time_s,
              claim.camera_from_enu.conjugate(),
              claim.place,
              claim.covariance,
              claim.covariance.bottomRightCorner<3, 3>().trace()};
    if (frame.told) {
      node.offset = node.offset * frame.told->CameraFromEnuLess(Vector3d::Zero());
      node.place -= frame.told->place;
    }
    return node;
  }

  /// The state of a frame according to a hypothesis of that frame, or of another frame if both have telemetry.
  [[nodiscard]] FlightState StateAt(std::size_t frame, const Node& node) const {
    FlightState state;
    state.place = node.place;
    state.camera_from_enu = node.offset.conjugate();
    if (flight_.frames[frame].told) {
      const ToldPose& told = *flight_.frames[frame].told;
      state.place += told.place;
      state.place_offset = -node.place;
      state.camera_from_enu = told.CameraFromEnuLess(Vector3d::Zero()) * state.camera_from_enu;
      const Attitude attitude = AttitudeOf(state.camera_from_enu * told.local_from_enu.conjugate());
      state.attitude_offset << WrapAngle(told.attitude.yaw_rad - attitude.yaw_rad),
          told.attitude.pitch_rad - attitude.pitch_rad, WrapAngle(told.attitude.roll_rad - attitude.roll_rad);
    }
    return state;
  }

 private:
  const Flight& flight_;
};

// The comparable hypotheses of one time window.
class Electorate {
 public:
  Electorate(const Flight& flight, std::span<const LandmarkSighting> sightings, const Carrier& carrier)
      : flight_(flight), sightings_(sightings), carrier_(carrier) {}

  /// Ordered by time; those of one sighting are adjacent.
  std::vector<Node> nodes;

  /// The hypothesis with the highest score, and the nodes that agree with it.
  struct Choice {
    std::optional<std::size_t> leader;
    std::vector<std::size_t> supporters;
    double score = 0;
    bool clear = false;  // no hypothesis outside the best one's gate has nearly the same score
  };

  [[nodiscard]] Choice Elect(const std::vector<bool>& wrong) const {
    Choice best;
    std::vector<std::pair<double, std::size_t>> scores;  // of all hypotheses tried
    for (const std::size_t leader : Candidates()) {
      if (wrong[nodes[leader].landmark]) continue;
      // Student's t distribution: large telemetry errors are rare, but possible.
      const double offset = SquaredOffset(nodes[leader]);
      Choice choice{.leader = leader, .supporters = {}, .score = -6 * std::log1p(offset / 6)};
      std::map<std::size_t, int> seen;  // number of sightings per landmark
      std::size_t n = 0;
      while (n < nodes.size()) {  // each sighting supports through its best-fitting landmark
        const std::size_t sighting = nodes[n].sighting;
        double nearest = kGate;
        std::optional<std::size_t> supporter;
        for (; n < nodes.size() && nodes[n].sighting == sighting; ++n) {
          if (wrong[nodes[n].landmark]) continue;
          const double distance = SquaredApart(nodes[leader], nodes[n]);
          if (distance >= nearest) continue;
          nearest = distance;
          supporter = n;
        }
        if (!supporter) continue;
        choice.supporters.push_back(*supporter);
        seen[nodes[*supporter].landmark] += 1;
      }
      if (seen.size() == 1 && offset > kGate) continue;  // a single landmark does not outvote telemetry
      for (const auto& [landmark, count] : seen) choice.score += kLandmarkWeight * std::log1p(count);
      scores.emplace_back(choice.score, leader);
      if (!best.leader || choice.score > best.score) best = std::move(choice);
    }
    constexpr double kClear = 1;
    best.clear = std::ranges::none_of(scores, [&](const auto& other) {
      return other.first > best.score - kClear && SquaredApart(nodes[*best.leader], nodes[other.second]) > kGate;
    });
    return best;
  }

 private:
  static constexpr double kGate = 22.46;  // chi-square gate, 6 degrees of freedom, 99.9 %

  // A subset of the hypotheses, spread over the window: all hypotheses of every n-th sighting, so that no landmark is
  // omitted.
  [[nodiscard]] std::vector<std::size_t> Candidates() const {
    constexpr std::size_t kMost = 120;
    const std::size_t stride = nodes.size() / kMost + 1;
    std::vector<std::size_t> candidates;
    std::size_t sightings = 0;
    for (std::size_t n = 0; n < nodes.size();) {
      const std::size_t sighting = nodes[n].sighting;
      const bool asked = sightings++ % stride == 0;
      for (; n < nodes.size() && nodes[n].sighting == sighting; ++n) {
        if (asked) candidates.push_back(n);
      }
    }
    return candidates;
  }

  // The squared Mahalanobis distance of two hypotheses; infinity if certainly outside the gate.
  [[nodiscard]] double SquaredApart(const Node& a, const Node& b) const {
    const Vector6 lost = carrier_.Variance(sightings_[a.sighting].frame, sightings_[b.sighting].frame);
    // A lower bound of the Mahalanobis distance: the translation alone, with the variance of its widest axis bounded by
    // the trace.
    const double widest = a.place_variance + b.place_variance + lost.tail<3>().sum();
    if ((a.place - b.place).squaredNorm() > kGate * widest) return std::numeric_limits<double>::infinity();
    Vector6 apart;
    apart << VectorOf(a.offset * b.offset.conjugate()), a.place - b.place;
    Matrix6 covariance = a.covariance + b.covariance;
    covariance.diagonal() += lost;
    return SquaredSigmas(apart, covariance);
  }

  // The squared Mahalanobis distance from telemetry.
  [[nodiscard]] double SquaredOffset(const Node& node) const {
    if (!flight_.frames[sightings_[node.sighting].frame].told) return 0;
    Vector6 apart;
    apart << VectorOf(node.offset), node.place;
    const FlightSigmas& sigmas = flight_.sigmas;
    const double walked_s = node.time_s - flight_.frames.front().time_s;
    Matrix6 covariance = node.covariance;
    covariance.topLeftCorner<3, 3>().diagonal().array() +=
        std::pow(sigmas.offset_attitude_rad, 2) + walked_s * std::pow(sigmas.drift_attitude_rad, 2);
    covariance.bottomRightCorner<3, 3>().diagonal().array() +=
        std::pow(sigmas.offset_position_m, 2) + walked_s * std::pow(sigmas.drift_position_m, 2);
    return SquaredSigmas(apart, covariance);
  }

  static constexpr double kLandmarkWeight = 3;

  const Flight& flight_;
  std::span<const LandmarkSighting> sightings_;
  const Carrier& carrier_;
};

// Interpolates between frames of known pose: the place linearly, the attitude by slerp; extrapolates as constant.
void FillGaps(const Flight& flight, const std::vector<bool>& known, std::vector<FlightState>& states) {
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
      const double share = (flight.frames[gap].time_s - flight.frames[*before].time_s) / whole_s;
      states[gap].place = (1 - share) * states[*before].place + share * states[k].place;
      states[gap].camera_from_enu = states[*before].camera_from_enu.slerp(share, states[k].camera_from_enu);
      states[gap].place_offset = states[*before].place_offset;
      states[gap].attitude_offset = states[*before].attitude_offset;
    }
    before = k;
  }
}

}  // namespace

PoseClaim ClaimOf(const LandmarkSighting& sighting, const FlightLandmark& landmark) {
  const Rigid3& seen = sighting.camera_from_landmark;
  const Rigid3& known = landmark.enu_from_landmark;
  const Rigid3 enu_from_camera = known * seen.Inverse();
  const Matrix3d rotation = enu_from_camera.rotation.toRotationMatrix();
  const Vector3d to_landmark = rotation * seen.translation;

  Matrix6 by_seen;
  by_seen << -rotation, Matrix3d::Zero(), -rotation * SkewOf(seen.translation), -rotation;
  Matrix6 by_known;
  by_known << Matrix3d::Identity(), Matrix3d::Zero(), SkewOf(to_landmark), Matrix3d::Identity();
  return {enu_from_camera.rotation.conjugate(), enu_from_camera.translation,
          by_seen * CovarianceOf(sighting.information) * by_seen.transpose() +
              by_known * landmark.prior_covariance * by_known.transpose()};
}

std::vector<std::optional<std::size_t>> FindAgreement(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                                      std::span<const LandmarkSighting> sightings,
                                                      const Candidates& candidates, const std::vector<bool>& wrong,
                                                      const NavigateOptions& options) {
  const Carrier carrier(flight);
  std::vector<std::optional<std::size_t>> landmark_of(sightings.size());
  Electorate electorate(flight, sightings, carrier);
  const auto decide = [&] {
    const Electorate::Choice choice = electorate.Elect(wrong);
    if (flight.has_told || choice.clear) {
      for (const std::size_t n : choice.supporters) {
        landmark_of[electorate.nodes[n].sighting] = electorate.nodes[n].landmark;
      }
    } else {
      // Ambiguous: accept the sightings with a single candidate landmark, and leave the others until more is known.
      for (const Node& node : electorate.nodes) {
        if (candidates.Of(node.sighting).size() == 1 && !wrong[node.landmark]) {
          landmark_of[node.sighting] = node.landmark;
        }
      }
    }
    electorate.nodes.clear();
  };
  const double window_s = carrier.WindowS(options.claim_sigma_m);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const double time_s = flight.frames[sightings[i].frame].time_s;
    // Only the hypotheses of one window are held in memory.
    if (!electorate.nodes.empty() && time_s - electorate.nodes.front().time_s > window_s) decide();
    for (const std::size_t landmark : candidates.Of(i)) {
      const Node node = carrier.NodeOf(sightings[i], i, landmark, ClaimOf(sightings[i], landmarks[landmark]));
      if (std::sqrt(node.place_variance / 3) <= options.claim_sigma_m) electorate.nodes.push_back(node);
    }
  }
  decide();
  return landmark_of;
}

std::vector<FlightState> StartOf(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                 std::span<const LandmarkSighting> sightings,
                                 std::span<const std::optional<std::size_t>> landmark_of) {
  const Carrier carrier(flight);
  // The most accurate hypothesis of each frame that has one.
  std::map<std::size_t, Node> best;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (!landmark_of[i]) continue;
    const Node node =
        carrier.NodeOf(sightings[i], i, *landmark_of[i], ClaimOf(sightings[i], landmarks[*landmark_of[i]]));
    const auto [at, is_new] = best.emplace(sightings[i].frame, node);
    if (!is_new && node.covariance.trace() < at->second.covariance.trace()) at->second = node;
  }
  std::vector<FlightState> states(flight.frames.size());
  std::vector<bool> known(flight.frames.size(), false);
  const Node as_told{.offset = Quaterniond::Identity(), .place = Vector3d::Zero(), .covariance = Matrix6::Zero()};
  for (std::size_t k = 0; k < flight.frames.size(); ++k) {
    if (const auto own = best.find(k); own != best.end()) {
      states[k] = carrier.StateAt(k, own->second);
      known[k] = true;
    } else if (flight.frames[k].told) {
      // Telemetry, corrected by the offset of the nearest frame with a hypothesis.
      const Node* nearest = &as_told;
      double apart_s = std::numeric_limits<double>::infinity();
      auto after = best.lower_bound(k);
      for (const int way : {0, 1}) {
        if (way == 0 ? after == best.end() : after == best.begin()) continue;
        const auto& [frame, node] = way == 0 ? *after : *std::prev(after);
        const double off_s = std::abs(flight.frames[frame].time_s - flight.frames[k].time_s);
        if (!flight.frames[frame].told || off_s >= apart_s) continue;
        apart_s = off_s;
        nearest = &node;
      }
      states[k] = carrier.StateAt(k, *nearest);
      known[k] = true;
    }
  }
  FillGaps(flight, known, states);
  return states;
}

}  // namespace victorious
