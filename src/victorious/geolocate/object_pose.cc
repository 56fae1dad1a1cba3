#include "victorious/geolocate/object_pose.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kLeastDepthM = 1e-3;
constexpr double kCauchyScale = 2;  // residuals of so many sigmas count half

Matrix3d Cross(const Vector3d& v) {
  return (Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

// The translation that fits best under a known rotation: linear in it.
std::optional<Vector3d> TranslationFor(std::span<const SeenPoint> points, const Quaterniond& rotation) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const auto& [point, seen] : points) {
    const Vector3d turned = rotation * point;
    for (int axis = 0; axis < 2; ++axis) {  // turned + t lies on the ray: X - x Z = 0
      Vector3d row = -seen[axis] * Vector3d::UnitZ();
      row[axis] += 1;
      normal += row * row.transpose();
      right -= row.dot(turned) * row;
    }
  }
  const Vector3d translation = normal.ldlt().solve(right);
  if (!translation.allFinite() || translation.z() <= 0) return std::nullopt;
  return translation;
}

class Fit {
 public:
  Fit(std::span<const SeenPoint> points, const Quaterniond& start, const ObjectPoseOptions& options)
      : points_(points), start_(start), options_(options) {}

  [[nodiscard]] double CostOf(const Rigid3& pose) const {
    double cost = PriorOf(pose).squaredNorm();
    for (const SeenPoint& point : points_) {
      const std::optional<Vector2d> off = OffsetOf(pose, point);
      if (!off) return std::numeric_limits<double>::infinity();
      cost += kCauchyScale * kCauchyScale * std::log1p(off->squaredNorm() / (kCauchyScale * kCauchyScale));
    }
    return cost;
  }

  /// The normal equations at `pose`: turns about the camera's axes, then moves along them.
  void Linearise(const Rigid3& pose, Matrix6& normal, Vector6& gradient) const {
    normal.setZero();
    gradient.setZero();
    for (const SeenPoint& point : points_) {
      const std::optional<Vector2d> off = OffsetOf(pose, point);
      if (!off) continue;
      const Vector3d turned = pose.rotation * point.point;
      const Vector3d p = turned + pose.translation;
      Eigen::Matrix<double, 2, 3> projection;
      projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << projection * -Cross(turned), projection;
      jacobian /= options_.sigma;
      const double weight = 1 / (1 + off->squaredNorm() / (kCauchyScale * kCauchyScale));
      normal += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * *off;
    }
    const Matrix3d prior = AcrossOf(pose) / options_.sigma_view_rad;
    normal.topLeftCorner<3, 3>() += prior.transpose() * prior;
    gradient.head<3>() += prior.transpose() * PriorOf(pose);
  }

  /// How much larger than sigma the offsets are, from their median; at least 1.
  [[nodiscard]] double NoiseFactor(const Rigid3& pose) const {
    std::vector<double> offsets;
    for (const SeenPoint& point : points_) {
      if (const auto off = OffsetOf(pose, point)) offsets.push_back(off->norm());
    }
    const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
    std::ranges::nth_element(offsets, middle);
    constexpr double kRayleighMedian = 1.1774100225154747;
    return std::max(1.0, *middle / kRayleighMedian);
  }

 private:
  [[nodiscard]] std::optional<Vector2d> OffsetOf(const Rigid3& pose, const SeenPoint& point) const {
    const Vector3d p = pose.Apply(point.point);
    if (p.z() < kLeastDepthM) return std::nullopt;
    return (Vector2d(p.x() / p.z(), p.y() / p.z()) - point.seen) / options_.sigma;
  }
  // A turn about the line of sight is seen well, and free.
  [[nodiscard]] static Matrix3d AcrossOf(const Rigid3& pose) {
    const Vector3d sight = pose.translation.normalized();
    return Matrix3d::Identity() - sight * sight.transpose();
  }
  [[nodiscard]] Vector3d PriorOf(const Rigid3& pose) const {
    const Eigen::AngleAxisd turn(pose.rotation * start_.conjugate());
    return AcrossOf(pose) * (turn.angle() * turn.axis()) / options_.sigma_view_rad;
  }

  std::span<const SeenPoint> points_;
  Quaterniond start_;
  const ObjectPoseOptions& options_;
};

Rigid3 Moved(const Rigid3& pose, const Vector6& step) {
  const Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  const Quaterniond rotation =
      angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) : Quaterniond::Identity();
  return {(rotation * pose.rotation).normalized(), pose.translation + step.tail<3>()};
}

Rigid3 Minimise(const Fit& fit, Rigid3 pose) {
  constexpr int kMostSteps = 30;
  constexpr double kSettled = 1e-6;
  double damping = 1e-4;
  double cost = fit.CostOf(pose);
  for (int i = 0; i < kMostSteps; ++i) {
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

}  // namespace

std::optional<ObjectPose> FitObjectPose(std::span<const SeenPoint> points, const Quaterniond& camera_from_object,
                                        const ObjectPoseOptions& options) {
  if (points.size() < 3) return std::nullopt;
  const auto translation = TranslationFor(points, camera_from_object);
  if (!translation) return std::nullopt;
  const Fit fit(points, camera_from_object, options);
  const Rigid3 pose = Minimise(fit, {camera_from_object, *translation});
  if (pose.translation.z() < kLeastDepthM) return std::nullopt;

  Matrix6 normal;
  Vector6 gradient;
  fit.Linearise(pose, normal, gradient);
  const double factor = fit.NoiseFactor(pose);
  const Matrix3d covariance = (factor * factor * normal.inverse()).bottomRightCorner<3, 3>();
  if (!covariance.allFinite()) return std::nullopt;
  const double range_m = pose.translation.norm();
  const Vector3d along = pose.translation / range_m;
  const double variance_along = along.dot(covariance * along);
  const double variance_across = std::max(0.0, covariance.trace() - variance_along) / 2;
  return ObjectPose{pose, std::sqrt(variance_across) / range_m, std::sqrt(std::max(0.0, variance_along))};
}

}  // namespace victorious
