#include "victorious/place/observe/landmark_sighting.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"

namespace victorious {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Residuals of this many standard deviations have half weight: as in the pose fit without MLESAC's weights
// (place/geolocate/object_pose.cc).
constexpr double kCauchyScale = 2;

// Standard deviation of the weak prior for unobserved directions, m: far above any range.
constexpr double kUnobservedSigma_m = 1e4;

struct Residual {
  Vector2d off;  // in standard deviations
  Eigen::Matrix<double, 2, 6> jacobian;
};

std::vector<Residual> ComputeResiduals(const ObjectPose& object_pose, double sigma) {
  std::vector<Residual> residuals;
  for (const PointObservation& point : object_pose.points) {
    const Vector3d turned = object_pose.camera_from_object->rotation * point.point;
    const Vector3d p = turned + object_pose.camera_from_object->translation;
    if (!(p.z() > 0)) continue;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    Residual& residual = residuals.emplace_back();
    residual.off = (p.head<2>() / p.z() - point.seen) / sigma;
    residual.jacobian << projection * -CrossProductMatrix(turned), projection;
    residual.jacobian /= sigma;
  }
  return residuals;
}

// Robust scale of the residuals, at least 1: inflates the covariance if they exceed the modelled noise.
double InflationFactor(const std::vector<Residual>& residuals) {
  std::vector<double> lengths;
  for (const Residual& residual : residuals) lengths.push_back(residual.off.norm());
  return std::max(1.0, MedianOr(std::move(lengths), 0) / kRayleighMedian);
}

// Covariance of (rotation, translation), from the points and the rotation prior of the matched view. Cauchy weights.
Matrix6 PoseCovariance(const ObjectPose& object_pose, const ObservationOptions& options) {
  const std::vector<Residual> residuals = ComputeResiduals(object_pose, options.point_sigma_px / object_pose.focal_px);
  const double factor = InflationFactor(residuals);
  const Matrix3d across = Matrix3d::Identity() - object_pose.direction * object_pose.direction.transpose();
  Matrix6 information = Matrix6::Zero();
  for (const Residual& residual : residuals) {
    const double weight = 1 / (1 + residual.off.squaredNorm() / (kCauchyScale * kCauchyScale));
    information += weight / (factor * factor) * residual.jacobian.transpose() * residual.jacobian;
  }
  information.topLeftCorner<3, 3>() += across / std::pow(RadiansFromDegrees(options.view_sigma_deg), 2);
  information.diagonal().array() +=
      Eigen::Array<double, 6, 1>((Vector6() << Vector3d::Constant(1 / (kPi * kPi)),
                                  Vector3d::Constant(1 / (kUnobservedSigma_m * kUnobservedSigma_m)))
                                     .finished());
  return information.llt().solve(Matrix6::Identity());
}

// Covariance of a rotation about the centroid of the points.
Matrix6 RotationCovariance(const ObjectPose& object_pose, const LandmarkSightingOptions& options) {
  Vector3d middle = Vector3d::Zero();
  for (const PointObservation& point : object_pose.points)
    middle += object_pose.camera_from_object->rotation * point.point;
  const double count = std::max<double>(1, static_cast<double>(object_pose.points.size()));
  const double sigma_rad =
      RadiansFromDegrees(std::hypot(options.min_rotation_sigma_deg, std::pow(options.reference_points / count, 2)));
  Eigen::Matrix<double, 6, 3> rotation_jacobian;
  rotation_jacobian << Matrix3d::Identity(), CrossProductMatrix(middle / count);
  return sigma_rad * sigma_rad * rotation_jacobian * rotation_jacobian.transpose();
}

}  // namespace

std::optional<LandmarkSighting> MakeLandmarkSighting(const ObjectPose& object_pose,
                                                     const ObservationOptions& observation,
                                                     const LandmarkSightingOptions& options) {
  if (!object_pose.range_m) return std::nullopt;
  LandmarkSighting sighting;
  const double range_m = *object_pose.range_m;
  const Matrix3d along = object_pose.direction * object_pose.direction.transpose();
  const Matrix3d across = Matrix3d::Identity() - along;
  if (!object_pose.camera_from_object) {
    sighting.camera_from_landmark.translation = range_m * object_pose.direction;
    sighting.information.bottomRightCorner<3, 3>() =
        across / std::pow(range_m * object_pose.sigma_rad, 2) + along / std::pow(object_pose.sigma_range_m, 2);
    return sighting;
  }
  sighting.camera_from_landmark = *object_pose.camera_from_object;
  Matrix6 covariance = PoseCovariance(object_pose, observation) + RotationCovariance(object_pose, options);
  covariance.bottomRightCorner<3, 3>() +=
      across * std::pow(range_m * observation.min_sigma_px / object_pose.focal_px, 2) +
      along * std::pow(observation.min_range_fraction * range_m, 2);
  sighting.information = covariance.llt().solve(Matrix6::Identity());
  if (!sighting.information.allFinite()) return std::nullopt;
  return sighting;
}

}  // namespace victorious
