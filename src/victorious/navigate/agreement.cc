#include "victorious/navigate/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// A claim less what telemetry tells of its frame: so it is comparable with those of other frames.
struct Node {
  std::size_t sighting = 0;
  std::size_t landmark = 0;
  double time_s = 0;
  Quaterniond offset;  // of enu_from_camera
  Vector3d place;
  Matrix6 covariance;
};

// What is lost on the way from one frame to another.
class Carrier {
 public:
  Carrier(const Flight& flight, const NavigateOptions& options) : flight_(flight), options_(options) {}

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

  /// So long a window that what is lost in it stays small beside what a claim may err.
  [[nodiscard]] double WindowS() const {
    const double allowed_m = options_.claim_sigma_m / 3;
    const double by_motion = allowed_m / flight_.sigmas.speed_m_s;
    if (!flight_.has_told) return by_motion;
    return std::max(by_motion, std::pow(allowed_m / std::max(1e-6, flight_.sigmas.drift_position_m), 2));
  }

  [[nodiscard]] Node NodeOf(const LandmarkSighting& sighting, std::size_t number, std::size_t landmark,
                            const PoseClaim& claim) const {
    const FlightFrame& frame = flight_.frames[sighting.frame];
    Node node{number, landmark, frame.time_s, claim.camera_from_enu.conjugate(), claim.place, claim.covariance};
    if (frame.told) {
      node.offset = node.offset * frame.told->CameraFromEnuLess(Vector3d::Zero());
      node.place -= frame.told->place;
    }
    return node;
  }

  /// The state in a frame that a node of it or of another frame with telemetry leads to.
  [[nodiscard]] FlightState StateAt(std::size_t frame, const Node& node, bool of_told) const {
    FlightState state;
    state.place = node.place;
    Quaterniond enu_from_camera = node.offset;
    if (of_told) {
      const ToldPose& told = *flight_.frames[frame].told;
      state.place += told.place;
      state.place_offset = -node.place;
      enu_from_camera = enu_from_camera * told.CameraFromEnuLess(Vector3d::Zero()).conjugate();
    }
    state.camera_from_enu = enu_from_camera.conjugate();
    if (of_told) {
      const ToldPose& told = *flight_.frames[frame].told;
      const Attitude attitude = AttitudeOf(state.camera_from_enu * told.local_from_enu.conjugate());
      state.attitude_offset << WrapAngle(told.attitude.yaw_rad - attitude.yaw_rad),
          told.attitude.pitch_rad - attitude.pitch_rad, WrapAngle(told.attitude.roll_rad - attitude.roll_rad);
    }
    return state;
  }

 private:
  const Flight& flight_;
  const NavigateOptions& options_;
};

class Electorate {
 public:
  Electorate(const Flight& flight, std::span<const FlightLandmark> landmarks,
             std::span<const LandmarkSighting> sightings, const NavigateOptions& options)
      : flight_(flight), sightings_(sightings), carrier_(flight, options) {
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      for (const std::size_t landmark : sightings[i].candidates) {
        const PoseClaim claim = ClaimOf(sightings[i], landmarks[landmark]);
        if (std::sqrt(claim.covariance.bottomRightCorner<3, 3>().trace() / 3) > options.claim_sigma_m) continue;
        nodes_.push_back(carrier_.NodeOf(sightings[i], i, landmark, claim));
      }
    }
    SplitIntoWindows();
  }

  /// A window's choice: the claim that leads, and which nodes agree with it.
  struct Choice {
    std::optional<std::size_t> leader;
    std::vector<std::size_t> supporters;
    double score = 0;
  };

  [[nodiscard]] std::vector<Choice> Elect(const std::vector<bool>& wrong) const {
    std::vector<Choice> choices;
    for (const auto& [first, last] : windows_) choices.push_back(ElectIn(first, last, wrong));
    return choices;
  }

  /// Landmarks that agree in fewer of their windows than in the others, while another is seen that does agree.
  [[nodiscard]] std::vector<bool> WrongOnes(const std::vector<Choice>& choices, std::size_t landmarks) const {
    std::vector<double> for_it(landmarks, 0);
    std::vector<double> against(landmarks, 0);
    for (std::size_t w = 0; w < choices.size(); ++w) {
      if (!choices[w].leader) continue;
      std::map<std::size_t, bool> agrees;  // by landmark
      for (std::size_t n = windows_[w].first; n < windows_[w].second; ++n) agrees.emplace(nodes_[n].landmark, false);
      std::vector<bool> explained(sightings_.size(), false);
      for (const std::size_t n : choices[w].supporters) {
        agrees[nodes_[n].landmark] = true;
        explained[nodes_[n].sighting] = true;
      }
      // A sighting that is another's, of the same model, is no word against it.
      std::map<std::size_t, std::pair<double, double>> unexplained;  // by landmark: unexplained, all
      for (std::size_t n = windows_[w].first; n < windows_[w].second; ++n) {
        auto& [open, all] = unexplained[nodes_[n].landmark];
        open += explained[nodes_[n].sighting] ? 0 : 1;
        all += 1;
      }
      for (const auto& [landmark, agreed] : agrees) {
        const auto& [open, all] = unexplained[landmark];
        (agreed ? for_it : against)[landmark] += agreed ? choices[w].score : choices[w].score * open / all;
      }
    }
    std::vector<bool> wrong(landmarks);
    for (std::size_t i = 0; i < landmarks; ++i) wrong[i] = against[i] > for_it[i];
    return wrong;
  }

  [[nodiscard]] const Node& node(std::size_t n) const { return nodes_[n]; }
  [[nodiscard]] const Carrier& carrier() const { return carrier_; }

 private:
  void SplitIntoWindows() {
    const double window_s = carrier_.WindowS();
    std::size_t first = 0;
    for (std::size_t n = 1; n <= nodes_.size(); ++n) {
      if (n < nodes_.size() && nodes_[n].time_s - nodes_[first].time_s <= window_s) continue;
      windows_.emplace_back(first, n);
      first = n;
    }
    if (nodes_.empty()) windows_.clear();
  }

  [[nodiscard]] double SquaredDistance(const Node& a, const Node& b) const {
    Vector6 apart;
    apart << VectorOf(a.offset * b.offset.conjugate()), a.place - b.place;
    Matrix6 covariance = a.covariance + b.covariance;
    covariance.diagonal() += carrier_.Variance(sightings_[a.sighting].frame, sightings_[b.sighting].frame);
    return apart.dot(covariance.llt().solve(apart));
  }

  // How far from what telemetry tells.
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
    return apart.dot(covariance.llt().solve(apart));
  }

  [[nodiscard]] Choice ElectIn(std::size_t first, std::size_t last, const std::vector<bool>& wrong) const {
    constexpr double kGate = 22.46;  // chi squared of 6, 99.9 %
    constexpr std::size_t kMostLeaders = 120;
    const std::size_t stride = (last - first) / kMostLeaders + 1;
    Choice best;
    for (std::size_t leader = first; leader < last; leader += stride) {
      if (wrong[nodes_[leader].landmark]) continue;
      // Student's t distribution: telemetry that is off by far is seldom, not impossible.
      const double offset = SquaredOffset(nodes_[leader]);
      Choice choice{.leader = leader, .supporters = {}, .score = -6 * std::log1p(offset / 6)};
      std::map<std::size_t, int> seen;  // sightings, by landmark
      std::size_t n = first;
      while (n < last) {  // each sighting agrees as the landmark that fits best
        const std::size_t sighting = nodes_[n].sighting;
        double nearest = kGate;
        std::optional<std::size_t> supporter;
        for (; n < last && nodes_[n].sighting == sighting; ++n) {
          if (wrong[nodes_[n].landmark]) continue;
          const double distance = SquaredDistance(nodes_[leader], nodes_[n]);
          if (distance >= nearest) continue;
          nearest = distance;
          supporter = n;
        }
        if (!supporter) continue;
        choice.supporters.push_back(*supporter);
        seen[nodes_[*supporter].landmark] += 1;
      }
      if (seen.size() == 1 && offset > kGate) continue;  // its word against telemetry's
      for (const auto& [landmark, count] : seen) choice.score += kLandmarkWeight * std::log1p(count);
      if (!best.leader || choice.score > best.score) best = std::move(choice);
    }
    return best;
  }

  static constexpr double kLandmarkWeight = 3;

  const Flight& flight_;
  std::span<const LandmarkSighting> sightings_;
  Carrier carrier_;
  std::vector<Node> nodes_;  // by time; those of a sighting together
  std::vector<std::pair<std::size_t, std::size_t>> windows_;
};

// Between frames of known pose: the place linear, the attitude on the sphere; beyond them as the nearest.
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

  // What was not seen may be anything.
  constexpr double kAnyM = 1e4;
  Matrix6 information = sighting.information;
  information.topLeftCorner<3, 3>().diagonal().array() += 1 / (kPi * kPi);
  information.bottomRightCorner<3, 3>().diagonal().array() += 1 / (kAnyM * kAnyM);
  Matrix6 by_seen;
  by_seen << -rotation, Matrix3d::Zero(), -rotation * SkewOf(seen.translation), -rotation;
  Matrix6 by_known;
  by_known << Matrix3d::Identity(), Matrix3d::Zero(), SkewOf(to_landmark), Matrix3d::Identity();
  return {enu_from_camera.rotation.conjugate(), enu_from_camera.translation,
          by_seen * information.llt().solve(Matrix6::Identity()) * by_seen.transpose() +
              by_known * landmark.prior_covariance * by_known.transpose()};
}

Agreement FindAgreement(const Flight& flight, std::span<const FlightLandmark> landmarks,
                        std::span<const LandmarkSighting> sightings, const NavigateOptions& options) {
  const Electorate electorate(flight, landmarks, sightings, options);
  std::vector<bool> wrong(landmarks.size(), false);
  std::vector<Electorate::Choice> choices = electorate.Elect(wrong);
  wrong = electorate.WrongOnes(choices, landmarks.size());
  if (std::ranges::find(wrong, true) != wrong.end()) choices = electorate.Elect(wrong);

  Agreement agreement;
  agreement.landmark_of.resize(sightings.size());
  agreement.wrong_landmarks = std::move(wrong);
  agreement.start.resize(flight.frames.size());
  std::vector<bool> known(flight.frames.size(), false);
  // A frame starts from its own best claim; with telemetry, from the claim that leads its window.
  std::vector<double> variance(flight.frames.size(), std::numeric_limits<double>::infinity());
  std::vector<std::pair<double, std::size_t>> leaders;  // by time
  for (const Electorate::Choice& choice : choices) {
    if (!choice.leader) continue;
    leaders.emplace_back(electorate.node(*choice.leader).time_s, *choice.leader);
    for (const std::size_t n : choice.supporters) {
      const Node& node = electorate.node(n);
      agreement.landmark_of[node.sighting] = node.landmark;
      const std::size_t frame = sightings[node.sighting].frame;
      const double own = node.covariance.trace();
      if (flight.frames[frame].told || own >= variance[frame]) continue;
      variance[frame] = own;
      known[frame] = true;
      agreement.start[frame] = electorate.carrier().StateAt(frame, node, false);
    }
  }
  Node none{.offset = Quaterniond::Identity(), .place = Vector3d::Zero(), .covariance = Matrix6::Zero()};
  for (std::size_t k = 0; k < flight.frames.size(); ++k) {
    if (!flight.frames[k].told) continue;
    const auto off = [&](const auto& leader) { return std::abs(leader.first - flight.frames[k].time_s); };
    const auto nearest = std::ranges::min_element(leaders, {}, off);
    const bool led =
        nearest != leaders.end() && flight.frames[sightings[electorate.node(nearest->second).sighting].frame].told;
    agreement.start[k] = electorate.carrier().StateAt(k, led ? electorate.node(nearest->second) : none, true);
    known[k] = true;
  }
  FillGaps(flight, known, agreement.start);
  return agreement;
}

}  // namespace victorious
