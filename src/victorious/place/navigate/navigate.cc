#include "victorious/place/navigate/navigate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/place/navigate/agreement.h"
#include "victorious/place/navigate/candidates.h"
#include "victorious/place/navigate/contradiction.h"
#include "victorious/place/navigate/covariance.h"
#include "victorious/place/navigate/smoother.h"

namespace victorious {
namespace {

using Eigen::AngleAxisd;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Minimum standard deviation of the independent noise of a telemetry row; raised to the scatter of the rows. Keeps rows
// that agree to the last digit from infinite weight.
constexpr double kMinPositionNoise_m = 0.05;
constexpr double kMinAttitudeNoise_deg = 0.05;

// Maximum number of rounds of data association and smoothing. One that is not stable then is taken as it is: it is
// within the gate of its own flight.
constexpr int kMaxRounds = 20;

// Residuals from which their scatter is estimated: of fewer the median is too uncertain to inflate covariances by.
constexpr std::size_t kMinResiduals = 10;

// Median of the chi-square distribution with 6 degrees of freedom.
constexpr double kChiSquaredMedianOf6 = 5.348;

TangentPlane MakeTangentPlane(const NavigationInput& input) {
  for (const NavigationFrame& frame : input.frames) {
    if (frame.measured) return TangentPlane(frame.measured->place);
  }
  for (const LandmarkSighting& sighting : input.sightings) {
    const std::vector<std::size_t>& model_landmarks = input.landmarks_by_model[sighting.model];
    if (!model_landmarks.empty()) return TangentPlane(input.landmarks[model_landmarks.front()].place);
  }
  return TangentPlane({});
}

// The standard deviation of telemetry rows about the interpolation of their neighbours.
struct RowNoise {
  double position_m = 0;
  double attitude_rad = 0;
};

RowNoise EstimateRowNoise(std::span<const CameraState> rows) {
  std::vector<double> places;
  std::vector<double> attitudes;
  for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
    const TangentPlane plane(rows[i].place);
    const double whole_s = rows[i + 1].time_s - rows[i - 1].time_s;
    const double fraction = (rows[i].time_s - rows[i - 1].time_s) / whole_s;
    // ratio of the difference's noise to that of one row
    const double factor = std::sqrt(1 + fraction * fraction + (1 - fraction) * (1 - fraction));
    const Vector3d off =
        (1 - fraction) * plane.EnuFromGeodetic(rows[i - 1].place) + fraction * plane.EnuFromGeodetic(rows[i + 1].place);
    for (const double axis : off) places.push_back(std::abs(axis) / factor);
    if (!rows[i - 1].attitude || !rows[i].attitude || !rows[i + 1].attitude) continue;
    const Quaterniond between =
        CameraFromEnu(*rows[i - 1].attitude).slerp(fraction, CameraFromEnu(*rows[i + 1].attitude));
    for (const double axis : VectorFromRotation(CameraFromEnu(*rows[i].attitude) * between.conjugate())) {
      attitudes.push_back(std::abs(axis) / factor);
    }
  }
  RowNoise noise{kMinPositionNoise_m, RadiansFromDegrees(kMinAttitudeNoise_deg)};
  if (!places.empty()) noise.position_m = std::max(noise.position_m, kMadToSigma * Median(places));
  if (!attitudes.empty()) noise.attitude_rad = std::max(noise.attitude_rad, kMadToSigma * Median(attitudes));
  return noise;
}

FlightSigmas MakeFlightSigmas(const NavigationInput& input, const NavigateOptions& options) {
  std::vector<double> positions_m;
  std::vector<double> attitudes_rad;
  for (const CameraState& row : input.rows) {
    if (row.sigma_position_m && *row.sigma_position_m > 0) positions_m.push_back(*row.sigma_position_m);
    if (row.sigma_attitude_rad && *row.sigma_attitude_rad > 0) attitudes_rad.push_back(*row.sigma_attitude_rad);
  }
  const TelemetryErrorOptions& telemetry = options.telemetry;
  return {.offset_position_m = MedianOr(std::move(positions_m), telemetry.position_m),
          .offset_attitude_rad = MedianOr(std::move(attitudes_rad), RadiansFromDegrees(telemetry.attitude_deg)),
          .drift_position_m = telemetry.position_drift_m,
          .drift_attitude_rad = RadiansFromDegrees(telemetry.attitude_drift_deg),
          .speed_m_s = options.motion.speed_m_s,
          .speed_change_m_s = options.motion.speed_change_m_s,
          .angular_rate_rad_s = RadiansFromDegrees(options.motion.angular_rate_deg_s),
          .angular_rate_change_rad_s = RadiansFromDegrees(options.motion.angular_rate_change_deg_s)};
}

FlightInput MakeFlight(const NavigationInput& input, const TangentPlane& plane, const NavigateOptions& options) {
  FlightInput flight{.frames = {}, .sigmas = MakeFlightSigmas(input, options)};
  const RowNoise noise = EstimateRowNoise(input.rows);
  const auto measured = static_cast<double>(
      std::ranges::count_if(input.frames, [](const NavigationFrame& frame) { return frame.measured.has_value(); }));
  // Frames between two rows repeat the same measurement: their sigmas are increased accordingly.
  const double repeats =
      std::sqrt(std::max(1.0, measured / std::max<double>(1, static_cast<double>(input.rows.size()))));
  for (const NavigationFrame& frame : input.frames) {
    FlightFrame next{frame.time_s, std::nullopt};
    if (frame.measured && frame.measured->attitude) {
      const Vector3d place = plane.EnuFromGeodetic(frame.measured->place);
      next.measured = TelemetryPose{place, *frame.measured->attitude, plane.LocalEnuFromEnu(place),
                                    repeats * noise.position_m, repeats * noise.attitude_rad};
      flight.has_telemetry = true;
    }
    flight.frames.push_back(next);
  }
  return flight;
}

// The landmark in the tangent plane; an unknown heading gets a standard deviation of pi.
FlightLandmark ToTangentPlane(const Landmark& landmark, const TangentPlane& plane,
                              const LandmarkErrorOptions& options) {
  const Vector3d place = plane.EnuFromGeodetic(landmark.place);
  const Quaterniond enu_from_local = plane.LocalEnuFromEnu(place).conjugate();
  // Its front is along x, which points east: a quarter turn from a heading of north.
  const Quaterniond local_from_landmark(AngleAxisd(kPi / 2 - landmark.heading_rad.value_or(0), Vector3d::UnitZ()));
  Matrix6 covariance = Matrix6::Zero();
  const double turn = std::pow(RadiansFromDegrees(options.rotation_deg), 2);
  const double heading = landmark.heading_rad ? std::pow(landmark.sigma_heading_rad, 2) : kPi * kPi;
  covariance.diagonal() << turn, turn, turn + heading, Vector3d::Constant(std::pow(options.centre_m, 2));
  covariance.bottomRightCorner<3, 3>() += enu_from_local * landmark.covariance_enu_m2 * enu_from_local.conjugate();
  return {{enu_from_local * local_from_landmark, place}, covariance};
}

std::vector<FlightLandmark> ToTangentPlane(std::span<const Landmark> landmarks, const TangentPlane& plane,
                                           const LandmarkErrorOptions& options) {
  std::vector<FlightLandmark> all;
  for (const Landmark& landmark : landmarks) all.push_back(ToTangentPlane(landmark, plane, options));
  return all;
}

// Excludes landmarks that are certainly too far from a sighting, by the translation alone: a cheap pre-test for
// thousands of landmarks.
class TranslationGate {
 public:
  TranslationGate(const LandmarkSighting& sighting, double noise, const SmoothedFlight& smoothed)
      : state_(smoothed.states[sighting.frame]), seen_(sighting.camera_from_landmark.translation) {
    const Eigen::MatrixXd& block = smoothed.covariances.blocks[sighting.frame];
    turn_variance_ = block.topLeftCorner<3, 3>().trace();
    variance_ = noise * CovarianceFromInformation(sighting.information).bottomRightCorner<3, 3>().trace() +
                4 * block.block<3, 3>(3, 3).trace();
  }

  /// True if outside the gate; the trace bounds the variance of the principal axis. Correlated errors count at most
  /// twice: once for the state and the landmark, once for its rotation and its place.
  [[nodiscard]] bool IsOutside(double squared_sigmas, const Rigid3& landmark, double place_variance) const {
    const Vector3d in_camera = state_.camera_from_enu * (landmark.translation - state_.place);
    const double variance_bound = variance_ + 4 * in_camera.squaredNorm() * turn_variance_ + 2 * place_variance;
    return (in_camera - seen_).squaredNorm() > squared_sigmas * variance_bound;
  }

 private:
  const FlightState& state_;
  Vector3d seen_;
  double turn_variance_ = 0;
  double variance_ = 0;
};

// Sightings of one landmark within `correlation_s` count as one: their information is divided by their number.
std::vector<LandmarkSighting> Decorrelate(const NavigationInput& input, double correlation_s) {
  std::vector<LandmarkSighting> decorrelated(input.sightings.begin(), input.sightings.end());
  if (correlation_s <= 0) return decorrelated;
  const auto time_of = [&](const LandmarkSighting& sighting) { return input.frames[sighting.frame].time_s; };
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < decorrelated.size(); ++i) {
    const double time_s = time_of(decorrelated[i]);
    while (time_of(decorrelated[first]) < time_s - correlation_s / 2) ++first;
    while (last < decorrelated.size() && time_of(decorrelated[last]) <= time_s + correlation_s / 2) ++last;
    std::vector<std::size_t> frames;  // frames with a sighting of the same model
    for (std::size_t k = first; k < last; ++k) {
      if (decorrelated[k].model == decorrelated[i].model) frames.push_back(decorrelated[k].frame);
    }
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    decorrelated[i].information /= static_cast<double>(frames.size());
  }
  return decorrelated;
}

// Alternates between data association and smoothing.
class Navigator {
 public:
  Navigator(const NavigationInput& input, const NavigateOptions& options)
      : options_(options),
        common_covariance_(input.common_covariance_enu_m2),
        plane_(MakeTangentPlane(input)),
        flight_(MakeFlight(input, plane_, options)),
        landmarks_(ToTangentPlane(input.landmarks, plane_, options.landmark)),
        sightings_(Decorrelate(input, options.landmark.correlation_s)),
        full_sightings_(input.sightings),
        candidates_(flight_, landmarks_, input.landmarks_by_model, full_sightings_, options),
        wrong_(landmarks_.size(), false) {}

  Navigation Solve() {
    Navigation navigation;
    auto& association = navigation.landmark_by_sighting;
    association = FindConsensusAssociation(flight_, landmarks_, full_sightings_, candidates_, wrong_);
    if (!flight_.has_telemetry) {
      wrong_ = FindContradictions(flight_, landmarks_, sightings_, association, options_);
      if (std::ranges::find(wrong_, true) != wrong_.end()) {
        association = FindConsensusAssociation(flight_, landmarks_, full_sightings_, candidates_, wrong_);
      }
    }
    std::vector<FlightState> start = EstimateInitialStates(flight_, landmarks_, full_sightings_, association);
    std::optional<SmoothedFlight> smoothed;
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!flight_.has_telemetry &&
          std::ranges::none_of(association, [](const auto& one) { return one.has_value(); })) {
        navigation.status = NavigationStatus::kNothingObserved;
        return navigation;
      }
      smoothed = Smooth(association, start);
      if (!smoothed) {
        return {.status = NavigationStatus::kUnsolvable,
                .frames = {},
                .landmark_by_sighting = std::vector<std::optional<std::size_t>>(association.size())};
      }
      start = smoothed->states;
      std::vector<std::optional<std::size_t>> updated = AssociateNearest(*smoothed);
      if (updated == association || round + 1 == kMaxRounds) break;
      association = std::move(updated);
    }
    navigation.frames = MakeFrames(*smoothed, association);
    return navigation;
  }

 private:
  std::optional<SmoothedFlight> Smooth(const std::vector<std::optional<std::size_t>>& association,
                                       const std::vector<FlightState>& start) {
    std::vector<FlightLandmark> used;
    std::vector<SightingConstraint> constraints;
    border_index_.assign(landmarks_.size(), std::nullopt);
    for (std::size_t i = 0; i < association.size(); ++i) {
      if (!association[i]) continue;
      std::optional<std::size_t>& place = border_index_[*association[i]];
      if (!place) {
        place = used.size();
        used.push_back(landmarks_[*association[i]]);
      }
      constraints.push_back({sightings_[i].frame, *place, sightings_[i].camera_from_landmark,
                             sightings_[i].information / covariance_scale_});
    }
    return SmoothFlight(flight_, used, constraints, start);
  }

  // Associates each sighting with the nearest landmark inside the gate.
  std::vector<std::optional<std::size_t>> AssociateNearest(const SmoothedFlight& smoothed) {
    std::vector<std::optional<std::size_t>> association(sightings_.size());
    std::vector<double> squares;
    for (std::size_t i = 0; i < full_sightings_.size(); ++i) {
      // Association is meaningful only where the flight predicts the sighting accurately enough.
      const Matrix3d position_covariance = smoothed.covariances.blocks[full_sightings_[i].frame].block<3, 3>(3, 3);
      if (std::sqrt(position_covariance.trace() / 3) > kMaxHypothesisSigma_m) continue;
      double nearest = options_.gate_sigma * options_.gate_sigma;
      const TranslationGate gate(full_sightings_[i], covariance_scale_, smoothed);
      for (const std::size_t landmark : candidates_.LandmarksFor(i)) {
        if (wrong_[landmark] ||
            gate.IsOutside(nearest, LandmarkPose(smoothed, landmark), PlaceVariance(smoothed, landmark)))
          continue;
        const double distance = InnovationSquared(full_sightings_[i], landmark, smoothed);
        if (distance >= nearest) continue;
        nearest = distance;
        association[i] = landmark;
      }
      if (association[i]) squares.push_back(SquaredResidual(full_sightings_[i], *association[i], smoothed));
    }
    // Sightings that scatter more than their covariances inflate the covariance.
    covariance_scale_ = squares.size() < kMinResiduals ? 1 : std::max(1.0, Median(squares) / kChiSquaredMedianOf6);
    return association;
  }

  [[nodiscard]] const Rigid3& LandmarkPose(const SmoothedFlight& smoothed, std::size_t landmark) const {
    const auto& used = border_index_[landmark];
    return used ? smoothed.landmarks[*used] : landmarks_[landmark].enu_from_landmark;
  }

  // The sum of the variances along the axes.
  [[nodiscard]] double PlaceVariance(const SmoothedFlight& smoothed, std::size_t landmark) const {
    const auto& used = border_index_[landmark];
    if (!used) return landmarks_[landmark].prior_covariance.bottomRightCorner<3, 3>().trace();
    const Index at = 6 * static_cast<Index>(*used) + 3;
    return smoothed.covariances.border.block<3, 3>(at, at).trace();
  }

  [[nodiscard]] double SquaredResidual(const LandmarkSighting& sighting, std::size_t landmark,
                                       const SmoothedFlight& smoothed) const {
    const Vector6 off =
        SightingError(sighting.camera_from_landmark, smoothed.states[sighting.frame], LandmarkPose(smoothed, landmark));
    return off.dot(sighting.information * off) * 6 / CountObservedDimensions(sighting.information);
  }

  // The normalised innovation squared of a sighting: by its own covariance and that of the prediction.
  [[nodiscard]] double InnovationSquared(const LandmarkSighting& sighting, std::size_t landmark,
                                         const SmoothedFlight& smoothed) const {
    const FlightState& state = smoothed.states[sighting.frame];
    const Rigid3& pose = LandmarkPose(smoothed, landmark);
    const SightingJacobian jacobian = ComputeSightingJacobian(state, pose);
    const Matrix6 of_state = smoothed.covariances.blocks[sighting.frame].topLeftCorner<6, 6>();
    const auto& used = border_index_[landmark];
    Matrix6 expected;
    if (used) {
      const Index at = 6 * static_cast<Index>(*used);
      const Matrix6 cross = smoothed.covariances.cross[sighting.frame].block<6, 6>(0, at);
      const Matrix6 mixed = jacobian.by_state * cross * jacobian.by_landmark.transpose();
      expected = jacobian.by_state * of_state * jacobian.by_state.transpose();
      expected +=
          mixed + mixed.transpose() +
          jacobian.by_landmark * smoothed.covariances.border.block<6, 6>(at, at) * jacobian.by_landmark.transpose();
    } else {
      expected = PredictionCovariance(jacobian, of_state, landmarks_[landmark].prior_covariance);
    }
    const Vector6 off = SightingError(sighting.camera_from_landmark, state, pose);
    return NormalisedInnovationSquared(off, sighting.information / covariance_scale_, expected);
  }

  [[nodiscard]] std::vector<NavigatedFrame> MakeFrames(
      const SmoothedFlight& smoothed, const std::vector<std::optional<std::size_t>>& association) const {
    std::vector<NavigatedFrame> frames(flight_.frames.size());
    const bool has_sighting = std::ranges::any_of(association, [](const auto& one) { return one.has_value(); });
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const FlightState& state = smoothed.states[k];
      const Eigen::MatrixXd& block = smoothed.covariances.blocks[k];
      const Quaterniond local_from_enu = plane_.LocalEnuFromEnu(state.place);
      Matrix6 local = Matrix6::Zero();  // (place, rotation) from (rotation, place)
      local.topRightCorner<3, 3>() = local_from_enu.toRotationMatrix();
      local.bottomLeftCorner<3, 3>().setIdentity();
      NavigatedFrame& frame = frames[k];
      frame.covariance = local * block.topLeftCorner<6, 6>() * local.transpose();
      if (has_sighting) frame.covariance.topLeftCorner<3, 3>() += common_covariance_;
      frame.camera.time_s = flight_.frames[k].time_s;
      frame.camera.place = plane_.GeodeticFromEnu(state.place);
      frame.camera.attitude = AttitudeFromRotation(state.camera_from_enu * local_from_enu.conjugate());
      frame.camera.sigma_position_m = std::sqrt(frame.covariance.topLeftCorner<3, 3>().trace() / 3);
      frame.camera.sigma_attitude_rad = std::sqrt(frame.covariance.bottomRightCorner<3, 3>().trace() / 3);
      if (!flight_.frames[k].measured) continue;
      Matrix6 of_offset = Matrix6::Identity();
      of_offset.topLeftCorner<3, 3>() = local_from_enu.toRotationMatrix();
      frame.offset = TelemetryOffset{local_from_enu * state.place_offset, state.attitude_offset,
                                     of_offset * block.bottomRightCorner<6, 6>() * of_offset.transpose()};
      if (has_sighting) frame.offset->covariance.topLeftCorner<3, 3>() += common_covariance_;
    }
    std::vector<std::pair<std::size_t, std::size_t>> seen;  // frame, landmark
    for (std::size_t i = 0; i < association.size(); ++i) {
      if (association[i]) seen.emplace_back(sightings_[i].frame, *association[i]);
    }
    std::ranges::sort(seen);
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (const auto& [frame, landmark] : seen) ++frames[frame].landmarks;
    return frames;
  }

  const NavigateOptions& options_;
  Matrix3d common_covariance_;  // covariance of the error common to all landmarks' places
  TangentPlane plane_;
  FlightInput flight_;
  std::vector<FlightLandmark> landmarks_;
  std::vector<LandmarkSighting> sightings_;           // with information reduced for correlation
  std::span<const LandmarkSighting> full_sightings_;  // with their full information
  Candidates candidates_;
  std::vector<bool> wrong_;
  std::vector<std::optional<std::size_t>> border_index_;  // one per landmark: index in the last smoothed flight
  double covariance_scale_ = 1;                           // factor of the sightings' covariances, from their scatter
};

}  // namespace

Expected<Navigation> Navigate(const NavigationInput& input, NavigateOptions options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (input.frames.empty()) {
    return Navigation{.status = NavigationStatus::kNothingObserved,
                      .frames = {},
                      .landmark_by_sighting = std::vector<std::optional<std::size_t>>(input.sightings.size())};
  }
  return Navigator(input, options).Solve();
}

}  // namespace victorious
