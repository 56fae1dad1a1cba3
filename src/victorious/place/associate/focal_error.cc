#include "victorious/place/associate/focal_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/focal_prior.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMinViews = 6;  // of an object
constexpr std::size_t kMinViewedObjects = 3;
// Views of one object that are seen within some frames share an error of its model.
constexpr double kCorrelatedViews = 3;
// An object that determines the logarithm less accurately says nothing.
constexpr double kMaxFocalSigma = 0.5;
// Larger corrections are another lens, which the motion of the image would have shown.
constexpr double kMaxFocalLog = 0.5;

// A view and the line of sight of its frame.
struct SeenView {
  Vector3d view;  // unit length, in axes fixed to the object
  double weight;
  double azimuth_rad;
  double elevation_rad;
  double azimuth_per_log;  // change with the logarithm of the focal length, rad
  double elevation_per_log;
};

// East-north-up, from the object to the camera.
Vector3d ToCamera(const SeenView& seen, double log_factor) {
  const double azimuth_rad = seen.azimuth_rad + log_factor * seen.azimuth_per_log;
  const double elevation_rad = seen.elevation_rad + log_factor * seen.elevation_per_log;
  const double level = std::cos(elevation_rad);
  return -Vector3d(level * std::sin(azimuth_rad), level * std::cos(azimuth_rad), std::sin(elevation_rad));
}

std::vector<SeenView> CollectViews(const ObservedTracklet& tracklet) {
  std::vector<SeenView> seen;
  auto observation = tracklet.observations.begin();
  for (const SightingView& view : tracklet.views) {
    while (observation != tracklet.observations.end() && observation->line.time_s < view.time_s) ++observation;
    if (observation == tracklet.observations.end()) break;
    const LineOfSight& line = observation->line;
    if (line.time_s != view.time_s || !view.sigma_rad || !line.focal_shift) continue;
    if (!(line.focal_shift->sigma > 0) || !(*view.sigma_rad > 0)) continue;
    seen.push_back({.view = view.direction,
                    .weight = 1 / (*view.sigma_rad * *view.sigma_rad),
                    .azimuth_rad = line.azimuth_rad,
                    .elevation_rad = line.elevation_rad,
                    .azimuth_per_log = line.focal_shift->azimuth_rad / line.focal_shift->sigma,
                    .elevation_per_log = line.focal_shift->elevation_rad / line.focal_shift->sigma});
  }
  return seen;
}

// The rotation from east-north-up to the object's axes that fits best (Kabsch's algorithm).
Matrix3d FitViewRotation(const std::vector<SeenView>& seen) {
  Matrix3d sum = Matrix3d::Zero();
  for (const SeenView& one : seen) sum += one.weight * one.view * ToCamera(one, 0).transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

struct FocalEstimate {
  double log_factor = 0;
  double variance = 0;
};

// Gauss-Newton in the logarithm and a small rotation; std::nullopt if the views determine nothing.
std::optional<FocalEstimate> EstimateOfOne(const ObservedTracklet& tracklet) {
  constexpr int kRounds = 8;
  constexpr double kStep = 1e-3;
  constexpr double kHuber = 2;
  const std::vector<SeenView> seen = CollectViews(tracklet);
  if (tracklet.is_of_photos || seen.size() < kMinViews) return std::nullopt;
  Matrix3d rotation = FitViewRotation(seen);
  double log_factor = 0;
  double misfit = 1;
  Eigen::Matrix4d normal;
  for (int round = 0; round < kRounds; ++round) {
    normal.setZero();
    normal(0, 0) = 1e-9;  // a camera whose lines are all on the axis
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double chi2 = 0;
    for (const SeenView& one : seen) {
      const Vector3d here = rotation * ToCamera(one, log_factor);
      const Vector3d residual = one.view - here;
      const double sigmas = std::sqrt(one.weight) * residual.norm();
      const double weight = one.weight * HuberWeight(sigmas / std::sqrt(std::max(1.0, misfit)), kHuber);
      Eigen::Matrix<double, 3, 4> change;  // of `here`
      change.col(0) = rotation * (ToCamera(one, log_factor + kStep) - ToCamera(one, log_factor)) / kStep;
      for (int axis = 0; axis < 3; ++axis) change.col(1 + axis) = Vector3d::Unit(axis).cross(here);
      normal += weight * change.transpose() * change;
      right += weight * change.transpose() * residual;
      chi2 += weight * residual.squaredNorm();
    }
    misfit = chi2 / (2 * static_cast<double>(seen.size()) - 4);
    const Eigen::LDLT<Eigen::Matrix4d> solver(normal);
    const Eigen::Vector4d step = solver.solve(right);
    if (solver.info() != Eigen::Success || !step.allFinite()) return std::nullopt;
    log_factor = std::clamp(log_factor + step[0], -1.0, 1.0);
    const Vector3d turn = step.tail<3>();
    if (turn.norm() > 0) rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * rotation;
  }
  const double formal = Eigen::LDLT<Eigen::Matrix4d>(normal).solve(Eigen::Vector4d::Unit(0))[0];
  const double variance = kCorrelatedViews * std::max(1.0, misfit) * formal;
  if (!(variance > 0) || variance > kMaxFocalSigma * kMaxFocalSigma) return std::nullopt;
  return FocalEstimate{.log_factor = log_factor, .variance = variance};
}

// The mean of the objects, robust against those that turn.
FocalEstimate Combine(std::span<const FocalEstimate> estimates) {
  constexpr int kRounds = 10;
  constexpr double kHuber = 1.5;
  FocalEstimate combined;
  for (int round = 0; round < kRounds; ++round) {
    double weights = 0;
    double sum = 0;
    for (const FocalEstimate& one : estimates) {
      const double sigmas = (one.log_factor - combined.log_factor) / std::sqrt(one.variance);
      const double weight = (round == 0 ? 1 : HuberWeight(sigmas, kHuber)) / one.variance;
      weights += weight;
      sum += weight * one.log_factor;
    }
    combined = {.log_factor = sum / weights, .variance = 1 / weights};
  }
  double chi2 = 0;
  for (const FocalEstimate& one : estimates)
    chi2 += (one.log_factor - combined.log_factor) * (one.log_factor - combined.log_factor) / one.variance;
  combined.variance *= std::max(1.0, chi2 / static_cast<double>(estimates.size() - 1));
  return combined;
}

// Mean, and variance about it, after the measurement. Many fields of view that are right are exact: the scale of their
// errors, at most that of the prior, is that which the measurement shows beyond twice its own standard error (after the
// positive part of James and Stein 1961). The variance is that of the prior's scale.
FocalEstimate Update(double given_sigma, const FocalEstimate& measured) {
  struct Hypothesis {
    double probability;
    double variance;
    double shown_variance;
  };
  constexpr double kRight = kRightFocalSigma * kRightFocalSigma;
  constexpr double kWrong = kWrongFocalSigma * kWrongFocalSigma;
  const double given = given_sigma * given_sigma;
  const double right = std::min(kRight, given);
  constexpr double kErrors = 2;
  const double shown = std::max(0.0, measured.log_factor * measured.log_factor - kErrors * kErrors * measured.variance);
  const double wrong = std::clamp((given - kRight) / (kWrong - kRight), 0.0, 1.0);
  // The exponent of the hypothesis that is taken away from both, so that one of them does not underflow.
  const double square = measured.log_factor * measured.log_factor;
  const double nearest = square / (2 * ((wrong > 0 ? kWrong : right) + measured.variance));
  double total = 0;
  FocalEstimate after;
  double mean = 0;
  double mean_square = 0;
  for (const auto& [probability, prior, shown_prior] :
       {Hypothesis{1 - wrong, right, std::min(right, shown)}, Hypothesis{wrong, kWrong, kWrong}}) {
    if (probability == 0) continue;
    const double spread = prior + measured.variance;
    const double density = std::exp(nearest - square / (2 * spread)) / std::sqrt(spread);
    const double expected = measured.log_factor * prior / spread;
    total += probability * density;
    after.log_factor += probability * density * measured.log_factor * shown_prior / (shown_prior + measured.variance);
    mean += probability * density * expected;
    mean_square += probability * density * (expected * expected + prior * measured.variance / spread);
  }
  after.log_factor /= total;
  after.variance = mean_square / total - after.log_factor * (2 * mean / total - after.log_factor);
  return after;
}

std::optional<double> GivenSigma(std::span<const ObservedTracklet> tracklets) {
  for (const ObservedTracklet& tracklet : tracklets) {
    for (const BearingObservation& observation : tracklet.observations) {
      if (observation.line.focal_shift) return observation.line.focal_shift->sigma;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<FocalError> EstimateFocalError(std::span<const ObservedTracklet> tracklets) {
  const std::optional<double> given_sigma = GivenSigma(tracklets);
  if (!given_sigma || !(*given_sigma > 0)) return std::nullopt;
  std::vector<FocalEstimate> estimates;
  for (const ObservedTracklet& tracklet : tracklets) {
    if (const auto estimate = EstimateOfOne(tracklet)) estimates.push_back(*estimate);
  }
  if (estimates.size() < kMinViewedObjects) return std::nullopt;
  const FocalEstimate left = Update(*given_sigma, Combine(estimates));
  if (std::abs(left.log_factor) > kMaxFocalLog) return std::nullopt;
  return FocalError{.log_factor = left.log_factor,
                    .sigma_ratio = std::sqrt(left.variance) / *given_sigma,
                    .objects = static_cast<int>(estimates.size())};
}

void CorrectFocalLength(const FocalError& error, std::span<ObservedTracklet> tracklets) {
  const double factor = std::exp(error.log_factor);
  for (ObservedTracklet& tracklet : tracklets) {
    for (BearingObservation& observation : tracklet.observations) {
      LineOfSight& line = observation.line;
      if (!line.focal_shift || !(line.focal_shift->sigma > 0)) continue;
      FocalShift& shift = *line.focal_shift;
      const double sigmas = error.log_factor / shift.sigma;
      line.azimuth_rad = WrapAngle(line.azimuth_rad + sigmas * shift.azimuth_rad);
      if (line.azimuth_rad < 0) line.azimuth_rad += 2 * kPi;
      line.elevation_rad += sigmas * shift.elevation_rad;
      if (line.range_m) *line.range_m *= factor;
      if (line.sigma_range_m) *line.sigma_range_m *= factor;
      for (double* of_shift : {&shift.sigma, &shift.azimuth_rad, &shift.elevation_rad}) *of_shift *= error.sigma_ratio;
    }
  }
}

}  // namespace victorious
