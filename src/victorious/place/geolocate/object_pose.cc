#include "victorious/place/geolocate/object_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/rotation_vector.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kMinDepthM = 1e-3;
constexpr double kCauchyScale = 2;  // residuals of this many sigmas have half weight

// The ratio of the inliers' residual variance to sigma^2, at least 1. For a small number of points the residuals are
// too small, because the pose is fitted to them and they were selected for agreement: the six unknowns are therefore
// subtracted twice.
double NoiseFactor2(std::span<const double> squared_offsets, std::span<const double> weights) {
  constexpr double kUnknowns = 6;
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < squared_offsets.size(); ++i) {
    const double weight = weights.empty() ? 1 / (1 + squared_offsets[i] / (kCauchyScale * kCauchyScale)) : weights[i];
    sum += weight * squared_offsets[i];
    count += weight;
  }
  return std::max(1.0, (sum + kUnknowns) / std::max(1.0, 2 * count - kUnknowns));
}

// The least-squares translation for a known rotation: linear. Empty weights are all 1.
std::optional<Vector3d> SolveTranslation(std::span<const PointObservation> points, const Quaterniond& rotation,
                                         std::span<const double> weights) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [point, seen] = points[i];
    const double weight = weights.empty() ? 1 : weights[i];
    const Vector3d turned = rotation * point;
    for (int axis = 0; axis < 2; ++axis) {  // turned + t lies on the ray: X - x Z = 0
      Vector3d row = -seen[axis] * Vector3d::UnitZ();
      row[axis] += 1;
      normal += weight * row * row.transpose();
      right -= weight * row.dot(turned) * row;
    }
  }
  const Vector3d translation = normal.ldlt().solve(right);
  if (!translation.allFinite() || translation.z() <= 0) return std::nullopt;
  return translation;
}

// The objective function.
class PoseObjective {
 public:
  /// @param weights  one per point, for weighted squared residuals; empty: Cauchy's loss
  PoseObjective(std::span<const PointObservation> points, const Quaterniond& start, const ObjectPoseFitOptions& options,
                std::span<const double> weights = {})
      : points_(points), weights_(weights), start_(start), options_(options) {}

  [[nodiscard]] double Cost(const Rigid3& pose) const {
    double cost = ViewPriorResidual(pose).squaredNorm() + UpPriorResidual(pose).squaredNorm();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::optional<Vector2d> residual = Residual(pose, points_[i]);
      if (!residual) return std::numeric_limits<double>::infinity();
      cost += weights_.empty() ? kCauchyScale * kCauchyScale * std::log1p(Excess(*residual))
                               : weights_[i] * residual->squaredNorm();
    }
    return cost;
  }

  /// The normal equations at `pose`: rotation about the camera's axes, then translation along them.
  void Linearise(const Rigid3& pose, Matrix6& normal, Vector6& gradient) const {
    normal.setZero();
    gradient.setZero();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const PointObservation& point = points_[i];
      const std::optional<Vector2d> residual = Residual(pose, point);
      if (!residual) continue;
      const Vector3d turned = pose.rotation * point.point;
      const Vector3d p = turned + pose.translation;
      Eigen::Matrix<double, 2, 3> projection;
      projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << projection * -CrossProductMatrix(turned), projection;
      jacobian /= options_.sigma;
      const double weight = weights_.empty() ? 1 / (1 + Excess(*residual)) : weights_[i];
      normal += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * *residual;
    }
    const Matrix3d view = AcrossLineOfSight(pose) / options_.sigma_view_rad;
    normal.topLeftCorner<3, 3>() += view.transpose() * view;
    gradient.head<3>() += view.transpose() * ViewPriorResidual(pose);
    if (!options_.up_in_camera) return;
    const Matrix3d up = -AcrossUp() * CrossProductMatrix(pose.rotation * Vector3d::UnitZ()) / options_.sigma_up_rad;
    normal.topLeftCorner<3, 3>() += up.transpose() * up;
    gradient.head<3>() += up.transpose() * UpPriorResidual(pose);
  }

  /// Squared residuals in sigmas; a very large number for a point that is not in front of the camera.
  void SquaredResiduals(const Rigid3& pose, std::span<double> out) const {
    constexpr double kVeryLarge = 1e12;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto residual = Residual(pose, points_[i]);
      out[i] = residual ? std::min(residual->squaredNorm(), kVeryLarge) : kVeryLarge;
    }
  }

 private:
  [[nodiscard]] std::optional<Vector2d> Residual(const Rigid3& pose, const PointObservation& point) const {
    const Vector3d p = pose.Apply(point.point);
    if (p.z() < kMinDepthM) return std::nullopt;
    return (Vector2d(p.x() / p.z(), p.y() / p.z()) - point.seen) / options_.sigma;
  }
  // A rotation about the optical ray to the object is well observed and has no prior.
  [[nodiscard]] static Matrix3d AcrossLineOfSight(const Rigid3& pose) {
    const Vector3d line_of_sight = pose.translation.normalized();
    return Matrix3d::Identity() - line_of_sight * line_of_sight.transpose();
  }
  [[nodiscard]] Vector3d ViewPriorResidual(const Rigid3& pose) const {
    const Eigen::AngleAxisd turn(pose.rotation * start_.conjugate());
    return AcrossLineOfSight(pose) * (turn.angle() * turn.axis()) / options_.sigma_view_rad;
  }
  [[nodiscard]] Matrix3d AcrossUp() const {
    return Matrix3d::Identity() - *options_.up_in_camera * options_.up_in_camera->transpose();
  }
  [[nodiscard]] Vector3d UpPriorResidual(const Rigid3& pose) const {
    if (!options_.up_in_camera) return Vector3d::Zero();
    return AcrossUp() * (pose.rotation * Vector3d::UnitZ()) / options_.sigma_up_rad;
  }
  [[nodiscard]] static double Excess(const Vector2d& residual) {
    return residual.squaredNorm() / (kCauchyScale * kCauchyScale);
  }

  std::span<const PointObservation> points_;
  std::span<const double> weights_;
  Quaterniond start_;
  const ObjectPoseFitOptions& options_;
};

Rigid3 ApplyStep(const Rigid3& pose, const Vector6& step) {
  return {(RotationFromVector(step.head<3>()) * pose.rotation).normalized(), pose.translation + step.tail<3>()};
}

Rigid3 Minimise(const PoseObjective& fit, Rigid3 pose, int max_steps) {
  constexpr double kTolerance = 1e-6;
  double damping = 1e-4;
  double cost = fit.Cost(pose);
  for (int i = 0; i < max_steps; ++i) {
    Matrix6 normal;
    Vector6 gradient;
    fit.Linearise(pose, normal, gradient);
    normal.diagonal() *= 1 + damping;
    const Rigid3 candidate = ApplyStep(pose, -normal.ldlt().solve(gradient));
    const double candidate_cost = candidate.translation.allFinite() ? fit.Cost(candidate) : cost;
    if (!(candidate_cost < cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = cost - candidate_cost < kTolerance * cost;
    pose = candidate;
    cost = candidate_cost;
    damping /= 10;
    if (settled) break;
  }
  return pose;
}

constexpr int kMaxSteps = 30;

// Estimator for MLESAC: the minimal sample that determines the pose together with the priors. Residuals are in sigmas
// instead of pixels.
class PoseEstimator {
 public:
  using Model = Rigid3;
  static constexpr std::size_t kSampleSize = 3;

  PoseEstimator(std::span<const PointObservation> points, const Quaterniond& start, const ObjectPoseFitOptions& options)
      : points_(points), start_(start), options_(options) {}

  [[nodiscard]] std::size_t size() const { return points_.size(); }

  [[nodiscard]] std::optional<Rigid3> FromSample(std::span<const std::uint32_t> sample) const {
    constexpr int kSampleSteps = 4;  // coarse: FromWeights refines the best hypothesis
    std::array<PointObservation, kSampleSize> sample_points;
    for (std::size_t i = 0; i < kSampleSize; ++i) sample_points[i] = points_[sample[i]];
    constexpr std::array<double, kSampleSize> kEqual = {1, 1, 1};
    return Solve(sample_points, kEqual, kSampleSteps);
  }

  void SquaredResiduals(const Rigid3& pose, std::span<double> out) const {
    PoseObjective(points_, start_, options_).SquaredResiduals(pose, out);
  }

  [[nodiscard]] static double SigmaPx(const Rigid3& /*pose*/) { return 1; }

  [[nodiscard]] std::optional<Rigid3> FromWeights(std::span<const double> weights) const {
    return Solve(points_, weights, kMaxSteps);
  }

 private:
  [[nodiscard]] std::optional<Rigid3> Solve(std::span<const PointObservation> points, std::span<const double> weights,
                                            int max_steps) const {
    const auto translation = SolveTranslation(points, start_, weights);
    if (!translation) return std::nullopt;
    return Minimise(PoseObjective(points, start_, options_, weights), {start_, *translation}, max_steps);
  }

  std::span<const PointObservation> points_;
  Quaterniond start_;
  const ObjectPoseFitOptions& options_;
};

// Initial value of the minimisation, and the points' weights as PoseObjective takes them.
struct InitialPose {
  Rigid3 pose;
  std::vector<double> weights;
};

std::optional<InitialPose> EstimateInitialPose(std::span<const PointObservation> points, const Quaterniond& rotation,
                                               const ObjectPoseFitOptions& options) {
  if (options.hypotheses > 0) {
    constexpr double kOutlierArea = 400;  // in sigmas squared: the matching window within which outliers lie
    auto consensus = Mlesac(PoseEstimator(points, rotation, options), {.outlier_area_px2 = kOutlierArea,
                                                                       .max_hypotheses = options.hypotheses,
                                                                       .refinements = 3,
                                                                       .seed = options.seed});
    if (consensus) return InitialPose{consensus->model, std::move(consensus->probabilities)};
  }
  const auto translation = SolveTranslation(points, rotation, {});
  if (!translation) return std::nullopt;
  return InitialPose{{rotation, *translation}, {}};
}

// Sigma of the direction to the camera in the object's frame, from the covariance of (rotation, translation).
double ViewSigma(const Rigid3& pose, const Matrix6& covariance) {
  // d = -R' t / |t|: a rotation w and a translation m change R d by -(w x s) - m across / |t|, where s is the direction
  // to the object.
  const double range_m = pose.translation.norm();
  const Vector3d line_of_sight = pose.translation / range_m;
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << -CrossProductMatrix(line_of_sight),
      -(Matrix3d::Identity() - line_of_sight * line_of_sight.transpose()) / range_m;
  return std::sqrt(std::max(0.0, (jacobian * covariance * jacobian.transpose()).trace() / 2));
}

}  // namespace

std::optional<ObjectPoseFit> FitObjectPose(std::span<const PointObservation> points,
                                           const Quaterniond& camera_from_object, const ObjectPoseFitOptions& options) {
  if (points.size() < 3) return std::nullopt;
  const auto start = EstimateInitialPose(points, camera_from_object, options);
  if (!start) return std::nullopt;
  const PoseObjective fit(points, camera_from_object, options, start->weights);
  const Rigid3 pose = Minimise(fit, start->pose, kMaxSteps);
  if (pose.translation.z() < kMinDepthM) return std::nullopt;

  Matrix6 normal;
  Vector6 gradient;
  fit.Linearise(pose, normal, gradient);
  std::vector<double> squared(points.size());
  fit.SquaredResiduals(pose, squared);
  const Matrix6 covariance = NoiseFactor2(squared, start->weights) * normal.inverse();
  if (!covariance.allFinite()) return std::nullopt;
  const Matrix3d position_covariance = covariance.bottomRightCorner<3, 3>();
  const double range_m = pose.translation.norm();
  const Vector3d along = pose.translation / range_m;
  const double variance_along = along.dot(position_covariance * along);
  const double variance_across = std::max(0.0, position_covariance.trace() - variance_along) / 2;
  return ObjectPoseFit{.camera_from_object = pose,
                       .sigma_angle_rad = std::sqrt(variance_across) / range_m,
                       .sigma_range_m = std::sqrt(std::max(0.0, variance_along)),
                       .sigma_view_rad = ViewSigma(pose, covariance)};
}

}  // namespace victorious
