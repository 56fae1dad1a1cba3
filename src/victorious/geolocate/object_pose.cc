#include "victorious/geolocate/object_pose.h"

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

constexpr double kLeastDepthM = 1e-3;
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
std::optional<Vector3d> TranslationFor(std::span<const SeenPoint> points, const Quaterniond& rotation,
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
class Fit {
 public:
  /// @param weights  one per point, for weighted squared residuals; empty: Cauchy's loss
  Fit(std::span<const SeenPoint> points, const Quaterniond& start, const ObjectPoseOptions& options,
      std::span<const double> weights = {})
      : points_(points), weights_(weights), start_(start), options_(options) {}

  [[nodiscard]] double CostOf(const Rigid3& pose) const {
    double cost = ViewPriorOf(pose).squaredNorm() + UpPriorOf(pose).squaredNorm();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::optional<Vector2d> off = OffsetOf(pose, points_[i]);
      if (!off) return std::numeric_limits<double>::infinity();
      cost +=
          weights_.empty() ? kCauchyScale * kCauchyScale * std::log1p(Excess(*off)) : weights_[i] * off->squaredNorm();
    }
    return cost;
  }

  /// The normal equations at `pose`: rotation about the camera's axes, then translation along them.
  void Linearise(const Rigid3& pose, Matrix6& normal, Vector6& gradient) const {
    normal.setZero();
    gradient.setZero();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const SeenPoint& point = points_[i];
      const std::optional<Vector2d> off = OffsetOf(pose, point);
      if (!off) continue;
      const Vector3d turned = pose.rotation * point.point;
      const Vector3d p = turned + pose.translation;
      Eigen::Matrix<double, 2, 3> projection;
      projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << projection * -SkewOf(turned), projection;
      jacobian /= options_.sigma;
      const double weight = weights_.empty() ? 1 / (1 + Excess(*off)) : weights_[i];
      normal += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * *off;
    }
    const Matrix3d view = AcrossOf(pose) / options_.sigma_view_rad;
    normal.topLeftCorner<3, 3>() += view.transpose() * view;
    gradient.head<3>() += view.transpose() * ViewPriorOf(pose);
    if (!options_.up_in_camera) return;
    const Matrix3d up = -OffUp() * SkewOf(pose.rotation * Vector3d::UnitZ()) / options_.sigma_up_rad;
    normal.topLeftCorner<3, 3>() += up.transpose() * up;
    gradient.head<3>() += up.transpose() * UpPriorOf(pose);
  }

  /// Squared residuals in sigmas; a very large number for a point that is not in front of the camera.
  void SquaredOffsets(const Rigid3& pose, std::span<double> out) const {
    constexpr double kVeryLarge = 1e12;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto off = OffsetOf(pose, points_[i]);
      out[i] = off ? std::min(off->squaredNorm(), kVeryLarge) : kVeryLarge;
    }
  }

 private:
  [[nodiscard]] std::optional<Vector2d> OffsetOf(const Rigid3& pose, const SeenPoint& point) const {
    const Vector3d p = pose.Apply(point.point);
    if (p.z() < kLeastDepthM) return std::nullopt;
    return (Vector2d(p.x() / p.z(), p.y() / p.z()) - point.seen) / options_.sigma;
  }
  // A rotation about the optical ray to the object is well observed and has no prior.
  [[nodiscard]] static Matrix3d AcrossOf(const Rigid3& pose) {
    const Vector3d sight = pose.translation.normalized();
    return Matrix3d::Identity() - sight * sight.transpose();
  }
  [[nodiscard]] Vector3d ViewPriorOf(const Rigid3& pose) const {
    const Eigen::AngleAxisd turn(pose.rotation * start_.conjugate());
    return AcrossOf(pose) * (turn.angle() * turn.axis()) / options_.sigma_view_rad;
  }
  [[nodiscard]] Matrix3d OffUp() const {
    return Matrix3d::Identity() - *options_.up_in_camera * options_.up_in_camera->transpose();
  }
  [[nodiscard]] Vector3d UpPriorOf(const Rigid3& pose) const {
    if (!options_.up_in_camera) return Vector3d::Zero();
    return OffUp() * (pose.rotation * Vector3d::UnitZ()) / options_.sigma_up_rad;
  }
  [[nodiscard]] static double Excess(const Vector2d& off) { return off.squaredNorm() / (kCauchyScale * kCauchyScale); }

  std::span<const SeenPoint> points_;
  std::span<const double> weights_;
  Quaterniond start_;
  const ObjectPoseOptions& options_;
};

Rigid3 Moved(const Rigid3& pose, const Vector6& step) {
  return {(RotationOf(step.head<3>()) * pose.rotation).normalized(), pose.translation + step.tail<3>()};
}

Rigid3 Minimise(const Fit& fit, Rigid3 pose, int most_steps) {
  constexpr double kSettled = 1e-6;
  double damping = 1e-4;
  double cost = fit.CostOf(pose);
  for (int i = 0; i < most_steps; ++i) {
    Matrix6 normal;
    Vector6 gradient;
    fit.Linearise(pose, normal, gradient);
    normal.diagonal() *= 1 + damping;
    const Rigid3 tried = Moved(pose, -normal.ldlt().solve(gradient));
    const double tried_cost = tried.translation.allFinite() ? fit.CostOf(tried) : cost;
    if (!(tried_cost < cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = cost - tried_cost < kSettled * cost;
    pose = tried;
    cost = tried_cost;
    damping /= 10;
    if (settled) break;
  }
  return pose;
}

constexpr int kMostSteps = 30;

// Estimator for MLESAC: the minimal sample that determines the pose together with the priors. Residuals are in sigmas
// instead of pixels.
class PoseEstimator {
 public:
  using Model = Rigid3;
  static constexpr std::size_t kSampleSize = 3;

  PoseEstimator(std::span<const SeenPoint> points, const Quaterniond& start, const ObjectPoseOptions& options)
      : points_(points), start_(start), options_(options) {}

  [[nodiscard]] std::size_t size() const { return points_.size(); }

  [[nodiscard]] std::optional<Rigid3> FromSample(std::span<const std::uint32_t> sample) const {
    constexpr int kFewSteps = 4;  // coarse: FromWeights refines the best hypothesis
    std::array<SeenPoint, kSampleSize> few;
    for (std::size_t i = 0; i < kSampleSize; ++i) few[i] = points_[sample[i]];
    constexpr std::array<double, kSampleSize> kEqual = {1, 1, 1};
    return Solve(few, kEqual, kFewSteps);
  }

  void SquaredResiduals(const Rigid3& pose, std::span<double> out) const {
    Fit(points_, start_, options_).SquaredOffsets(pose, out);
  }

  [[nodiscard]] static double SigmaPx(const Rigid3& /*pose*/) { return 1; }

  [[nodiscard]] std::optional<Rigid3> FromWeights(std::span<const double> weights) const {
    return Solve(points_, weights, kMostSteps);
  }

 private:
  [[nodiscard]] std::optional<Rigid3> Solve(std::span<const SeenPoint> points, std::span<const double> weights,
                                            int most_steps) const {
    const auto translation = TranslationFor(points, start_, weights);
    if (!translation) return std::nullopt;
    return Minimise(Fit(points, start_, options_, weights), {start_, *translation}, most_steps);
  }

  std::span<const SeenPoint> points_;
  Quaterniond start_;
  const ObjectPoseOptions& options_;
};

// Initial value of the minimisation, and the points' weights as PoseObjective takes them.
struct Start {
  Rigid3 pose;
  std::vector<double> weights;
};

std::optional<Start> StartOf(std::span<const SeenPoint> points, const Quaterniond& rotation,
                             const ObjectPoseOptions& options) {
  if (options.hypotheses > 0) {
    constexpr double kOutlierArea = 400;  // in sigmas squared: the matching window within which outliers lie
    auto agreed = Mlesac(PoseEstimator(points, rotation, options), {.outlier_area_px2 = kOutlierArea,
                                                                    .max_hypotheses = options.hypotheses,
                                                                    .refinements = 3,
                                                                    .seed = options.seed});
    if (agreed) return Start{agreed->model, std::move(agreed->probabilities)};
  }
  const auto translation = TranslationFor(points, rotation, {});
  if (!translation) return std::nullopt;
  return Start{{rotation, *translation}, {}};
}

// Sigma of the direction to the camera in the object's frame, from the covariance of (rotation, translation).
double ViewSigma(const Rigid3& pose, const Matrix6& covariance) {
  // d = -R' t / |t|: a rotation w and a translation m change R d by -(w x s) - m across / |t|, where s is the direction
  // to the object.
  const double range_m = pose.translation.norm();
  const Vector3d sight = pose.translation / range_m;
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << -SkewOf(sight), -(Matrix3d::Identity() - sight * sight.transpose()) / range_m;
  return std::sqrt(std::max(0.0, (jacobian * covariance * jacobian.transpose()).trace() / 2));
}

}  // namespace

std::optional<ObjectPose> FitObjectPose(std::span<const SeenPoint> points, const Quaterniond& camera_from_object,
                                        const ObjectPoseOptions& options) {
  if (points.size() < 3) return std::nullopt;
  const auto start = StartOf(points, camera_from_object, options);
  if (!start) return std::nullopt;
  const Fit fit(points, camera_from_object, options, start->weights);
  const Rigid3 pose = Minimise(fit, start->pose, kMostSteps);
  if (pose.translation.z() < kLeastDepthM) return std::nullopt;

  Matrix6 normal;
  Vector6 gradient;
  fit.Linearise(pose, normal, gradient);
  std::vector<double> squared(points.size());
  fit.SquaredOffsets(pose, squared);
  const Matrix6 covariance = NoiseFactor2(squared, start->weights) * normal.inverse();
  if (!covariance.allFinite()) return std::nullopt;
  const Matrix3d of_place = covariance.bottomRightCorner<3, 3>();
  const double range_m = pose.translation.norm();
  const Vector3d along = pose.translation / range_m;
  const double variance_along = along.dot(of_place * along);
  const double variance_across = std::max(0.0, of_place.trace() - variance_along) / 2;
  return ObjectPose{.camera_from_object = pose,
                    .sigma_angle_rad = std::sqrt(variance_across) / range_m,
                    .sigma_range_m = std::sqrt(std::max(0.0, variance_along)),
                    .sigma_view_rad = ViewSigma(pose, covariance)};
}

}  // namespace victorious
