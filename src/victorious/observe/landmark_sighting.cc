#include "victorious/observe/landmark_sighting.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"

namespace victorious {

void SightingOptions::ListFields(FieldList& fields) {
  fields.Add("least_turn_deg", least_turn_deg,
             {.min = 1e-3,
              .max = 90,
              .unit = "deg",
              .reason = "minimum standard deviation of a landmark's rotation in one frame"});
  fields.Add(
      "sure_points", sure_points,
      {.min = 0,
       .max = 1e4,
       .unit = "points",
       .reason =
           "adds the square of this over the number of matched points, in degrees, to that standard deviation: up to a "
           "third of this number of points may be matched to a wrong view, three times this number never are"});
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Offset {
  Vector2d off;  // in standard deviations
  Eigen::Matrix<double, 2, 6> jacobian;
};

std::vector<Offset> OffsetsOf(const Stance& stance, double sigma) {
  std::vector<Offset> offsets;
  for (const SeenPoint& point : stance.points) {
    const Vector3d turned = stance.camera_from_object->rotation * point.point;
    const Vector3d p = turned + stance.camera_from_object->translation;
    if (!(p.z() > 0)) continue;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    Offset& offset = offsets.emplace_back();
    offset.off = (p.head<2>() / p.z() - point.seen) / sigma;
    offset.jacobian << projection * -SkewOf(turned), projection;
    offset.jacobian /= sigma;
  }
  return offsets;
}

// Robust scale of the residuals, at least 1: inflates the covariance if they exceed the modelled noise.
double NoiseFactor(const std::vector<Offset>& offsets) {
  std::vector<double> lengths;
  for (const Offset& offset : offsets) lengths.push_back(offset.off.norm());
  return std::max(1.0, Median(std::move(lengths)) / kRayleighMedian);
}

// Covariance of (rotation, translation), from the points and the rotation prior of the matched view. Cauchy weights.
Matrix6 CovarianceOf(const Stance& stance, const SightOptions& options) {
  const std::vector<Offset> offsets = OffsetsOf(stance, options.point_sigma_px / stance.focal_px);
  const double factor = NoiseFactor(offsets);
  const Matrix3d across = Matrix3d::Identity() - stance.direction * stance.direction.transpose();
  Matrix6 information = Matrix6::Zero();
  for (const Offset& offset : offsets) {
    constexpr double kCauchyScale = 2;
    const double weight = 1 / (1 + offset.off.squaredNorm() / (kCauchyScale * kCauchyScale));
    information += weight / (factor * factor) * offset.jacobian.transpose() * offset.jacobian;
  }
  information.topLeftCorner<3, 3>() += across / std::pow(RadiansFromDegrees(options.view_sigma_deg), 2);
  constexpr double kAnyM = 1e4;  // weak prior for unobserved directions
  information.diagonal().array() += Eigen::Array<double, 6, 1>(
      (Vector6() << Vector3d::Constant(1 / (kPi * kPi)), Vector3d::Constant(1 / (kAnyM * kAnyM))).finished());
  return information.llt().solve(Matrix6::Identity());
}

// Covariance of a rotation about the centroid of the points.
Matrix6 TurnCovarianceOf(const Stance& stance, const SightingOptions& options) {
  Vector3d middle = Vector3d::Zero();
  for (const SeenPoint& point : stance.points) middle += stance.camera_from_object->rotation * point.point;
  const double count = std::max<double>(1, static_cast<double>(stance.points.size()));
  const double sigma_rad =
      RadiansFromDegrees(std::hypot(options.least_turn_deg, std::pow(options.sure_points / count, 2)));
  Eigen::Matrix<double, 6, 3> by_turn;
  by_turn << Matrix3d::Identity(), SkewOf(middle / count);
  return sigma_rad * sigma_rad * by_turn * by_turn.transpose();
}

}  // namespace

std::optional<LandmarkSighting> SightingOf(const Stance& stance, const SightOptions& sight,
                                           const SightingOptions& options) {
  if (!stance.range_m) return std::nullopt;
  LandmarkSighting sighting;
  const double range_m = *stance.range_m;
  const Matrix3d along = stance.direction * stance.direction.transpose();
  const Matrix3d across = Matrix3d::Identity() - along;
  if (!stance.camera_from_object) {
    sighting.camera_from_landmark.translation = range_m * stance.direction;
    sighting.information.bottomRightCorner<3, 3>() =
        across / std::pow(range_m * stance.sigma_rad, 2) + along / std::pow(stance.sigma_range_m, 2);
    return sighting;
  }
  sighting.camera_from_landmark = *stance.camera_from_object;
  Matrix6 covariance = CovarianceOf(stance, sight) + TurnCovarianceOf(stance, options);
  covariance.bottomRightCorner<3, 3>() += across * std::pow(range_m * sight.least_sigma_px / stance.focal_px, 2) +
                                          along * std::pow(sight.least_range_share * range_m, 2);
  sighting.information = covariance.llt().solve(Matrix6::Identity());
  if (!sighting.information.allFinite()) return std::nullopt;
  return sighting;
}

}  // namespace victorious
