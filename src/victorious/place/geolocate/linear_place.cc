#include "victorious/place/geolocate/linear_place.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/unit_diagonal.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

// Minimum pivot of a matrix with unit diagonal; below it the system is singular: lines parallel within 1e-6 rad.
constexpr double kMinPivot = 1e-12;

// The factorised system, with its unknowns scaled to a unit diagonal: metres and metres per second become comparable.
struct ScaledFactorisation {
  SmallVector scale;
  Eigen::LDLT<SmallMatrix> factors;
};

std::optional<ScaledFactorisation> FactoriseScaled(const SmallMatrix& matrix) {
  const auto unit = ScaleToUnitDiagonal(matrix);
  if (!unit) return std::nullopt;
  ScaledFactorisation scaled{.scale = unit->scale, .factors = {}};
  scaled.factors.compute(unit->matrix);
  if (scaled.factors.info() != Eigen::Success || !(scaled.factors.vectorD().minCoeff() > kMinPivot))
    return std::nullopt;
  return scaled;
}

Matrix3d ObservationWeight(const Ray& ray) {
  return Matrix3d::Identity() - (1 - ray.range_weight) * ray.forward * ray.forward.transpose();
}

// Maps an error of the observed point to the point. If the range is from the ground, it changes with the ray such that
// the point stays on the ground.
Matrix3d PointFromError(const Ray& ray) {
  if (ray.range_source != RangeSource::kGround || ray.range_weight == 0) return Matrix3d::Identity();
  return Matrix3d::Identity() - ray.forward * ray.normal.transpose() / ray.forward.dot(ray.normal);
}

using OwnErrorJacobian = Eigen::Matrix<double, 3, 5>;

// Columns: displacement of the observed point by one sigma of each of the ray's own errors: east, north, up, side,
// rise.
OwnErrorJacobian ComputeOwnErrorJacobian(const Ray& ray, double distance_m, const LocateOptions& options) {
  OwnErrorJacobian jacobian;
  jacobian << options.line.position_m * Matrix3d::Identity(), distance_m * ray.sigma_rad * ray.side,
      distance_m * ray.sigma_rad * ray.rise;
  return PointFromError(ray) * jacobian;
}

Matrix3d RangeCovariance(const Ray& ray) {
  if (ray.range_source != RangeSource::kMeasured) return Matrix3d::Zero();
  return ray.sigma_range_m * ray.sigma_range_m * ray.forward * ray.forward.transpose();
}

using CommonErrorJacobian = Eigen::Matrix<double, 3, kNumCommonErrors + 1>;  // last column: the ground's height

// Columns: displacement of the observed point by one sigma of each common error.
CommonErrorJacobian ComputeCommonErrorJacobian(const Ray& ray, double distance_m, const LocateOptions& options) {
  CommonErrorJacobian jacobian = CommonErrorJacobian::Zero();
  jacobian.leftCols<3>() = Matrix3d::Identity();
  jacobian.col(3) = distance_m * ray.cos_elevation * ray.side;
  jacobian.col(4) = distance_m * ray.side;
  jacobian.col(5) = distance_m * ray.rise;
  jacobian.leftCols<kNumCommonErrors>() = PointFromError(ray) * jacobian.leftCols<kNumCommonErrors>();
  if (ray.range_source == RangeSource::kMeasured) jacobian.col(6) = ray.range_m * ray.forward;
  jacobian.leftCols<kNumCommonErrors>() *= CommonErrorSigmas(options.common).asDiagonal();
  if (ray.range_source == RangeSource::kGround) {
    jacobian.col(kNumCommonErrors) = options.ground_sigma_m * ray.range_per_height * ray.forward;
  }
  return jacobian;
}

// The fraction of the variance of the rays' own errors that is independent between rays, estimated from the rays'
// offsets from the object. The remainder is common to all rays: the errors of a stationary camera repeat in every
// frame.
double IndependentFraction(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& motion,
                           const LocateOptions& options) {
  double squares = 0;
  double degrees_of_freedom = options.motion == MotionModel::kVelocity ? -6 : -3;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!chosen[i]) continue;
    const Vector3d to_object = motion.At(rays[i].time_s) - rays[i].camera;
    const double along_m = to_object.dot(rays[i].forward);
    const double off2 = (to_object - along_m * rays[i].forward).squaredNorm();
    squares += off2 / (std::pow(along_m * rays[i].sigma_rad, 2) + std::pow(options.line.position_m, 2));
    degrees_of_freedom += 2;
  }
  return degrees_of_freedom > 0 ? std::min(1.0, squares / degrees_of_freedom) : 1;
}

// The transposed design matrix: derivative of the point at the ray's time by the unknowns, place then velocity.
MatrixXd TransposedDesign(const Ray& ray, Eigen::Index unknowns) {
  MatrixXd design(unknowns, 3);
  design.topRows<3>().setIdentity();
  if (unknowns == 6) design.bottomRows<3>() = ray.time_s * Matrix3d::Identity();
  return design;
}

}  // namespace

Eigen::Matrix<double, kNumCommonErrors, 1> CommonErrorSigmas(const CommonErrorOptions& options) {
  Eigen::Matrix<double, kNumCommonErrors, 1> sigmas;
  sigmas << options.position_m, options.position_m, options.height_m, RadiansFromDegrees(options.heading_deg),
      RadiansFromDegrees(options.boresight_side_deg), RadiansFromDegrees(options.boresight_rise_deg),
      options.range_fraction;
  return sigmas;
}

void NormalEquations::Add(const Ray& ray, const Vector3d& along, double distance_m) {
  const Matrix3d weight = Matrix3d::Identity() - (1 - ray.range_weight) * along * along.transpose();
  const Vector3d across = ray.forward - along * along.dot(ray.forward);
  const Vector3d rhs = weight * ray.camera + distance_m * across + ray.range_weight * ray.range_m * along;
  AddWeight(weight, ray.time_s);
  rhs_.head<3>() += rhs;
  rhs_.tail<3>() += ray.time_s * rhs;
}

void NormalEquations::SubtractNoise(const Ray& ray, double variance) {
  AddWeight(-variance * (1 - ray.range_weight) * ray.forward * ray.forward.transpose(), ray.time_s);
}

void NormalEquations::AddWeight(const Matrix3d& weight, double time_s) {
  matrix_.topLeftCorner<3, 3>() += weight;
  if (unknowns_ == 3) return;
  matrix_.topRightCorner<3, 3>() += time_s * weight;
  matrix_.bottomLeftCorner<3, 3>() += time_s * weight;
  matrix_.bottomRightCorner<3, 3>() += time_s * time_s * weight;
}

void NormalEquations::Clear() {
  matrix_.setZero();
  rhs_.setZero();
}

std::optional<Motion> NormalEquations::Solve() const {
  const auto scaled = FactoriseScaled(matrix_.topLeftCorner(unknowns_, unknowns_));
  if (!scaled) return std::nullopt;
  const SmallVector rhs = scaled->scale.cwiseProduct(rhs_.head(unknowns_));
  const SmallVector solution = scaled->scale.cwiseProduct(SmallVector(scaled->factors.solve(rhs)));
  if (!solution.allFinite()) return std::nullopt;
  Motion motion;
  motion.place = solution.head<3>();
  if (unknowns_ == 6) motion.velocity = solution.tail<3>();
  return motion;
}

std::optional<MatrixXd> NormalEquations::Inverse() const {
  const auto scaled = FactoriseScaled(matrix_.topLeftCorner(unknowns_, unknowns_));
  if (!scaled) return std::nullopt;
  const SmallMatrix inverse = scaled->factors.solve(SmallMatrix::Identity(unknowns_, unknowns_));
  return MatrixXd(scaled->scale.asDiagonal() * inverse * scaled->scale.asDiagonal());
}

std::optional<Motion> SolveLinear(std::span<const Ray> rays, const std::vector<bool>& chosen, bool moving) {
  NormalEquations system(moving);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (chosen[i]) system.Add(rays[i]);
  }
  return system.Solve();
}

std::optional<Motion> SolveUnbiased(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& start,
                                    const LocateOptions& options) {
  Motion motion = start;
  constexpr int kMaxRounds = 10;
  for (int round = 0; round < kMaxRounds; ++round) {
    NormalEquations system(options.motion == MotionModel::kVelocity);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!chosen[i]) continue;
      const Vector3d to_object = motion.At(rays[i].time_s) - rays[i].camera;
      system.Add(rays[i], MaxLikelihoodDirection(rays[i], rays[i].forward, to_object, options.line.position_m),
                 to_object.norm());
    }
    const auto next = system.Solve();
    if (!next) return std::nullopt;
    constexpr double kToleranceM = 1e-3;
    const bool converged = (next->place - motion.place).norm() < kToleranceM;
    motion = *next;
    if (converged) break;
  }
  return motion;
}

std::optional<MatrixXd> LinearCovariance(std::span<const Ray> rays, const std::vector<bool>& chosen,
                                         const Motion& motion, const LocateOptions& options,
                                         bool estimate_correlation) {
  const bool moving = options.motion == MotionModel::kVelocity;
  const Eigen::Index unknowns = moving ? 6 : 3;
  NormalEquations system(moving);
  const double noise_bias_factor = NoiseBiasFactor(std::ranges::count(chosen, true));
  const double independent_fraction = estimate_correlation ? IndependentFraction(rays, chosen, motion, options) : 1;
  MatrixXd own = MatrixXd::Zero(unknowns, unknowns);
  MatrixXd correlated =
      MatrixXd::Zero(unknowns, OwnErrorJacobian::ColsAtCompileTime);  // common part of the rays' own errors
  MatrixXd common = MatrixXd::Zero(unknowns, kNumCommonErrors + 1);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!chosen[i]) continue;
    const Ray& ray = rays[i];
    system.Add(ray);
    const double distance_m = (motion.At(ray.time_s) - ray.camera).norm();
    system.SubtractNoise(ray, noise_bias_factor * ray.sigma_rad * ray.sigma_rad);
    const MatrixXd gain = TransposedDesign(ray, unknowns) * ObservationWeight(ray);
    const OwnErrorJacobian jacobian = ComputeOwnErrorJacobian(ray, distance_m, options);
    own += gain * (independent_fraction * jacobian * jacobian.transpose() + RangeCovariance(ray)) * gain.transpose();
    correlated += std::sqrt(1 - independent_fraction) * gain * jacobian;
    common += gain * ComputeCommonErrorJacobian(ray, distance_m, options);
  }
  const auto inverse = system.Inverse();
  if (!inverse) return std::nullopt;
  return MatrixXd(*inverse * (own + correlated * correlated.transpose() + common * common.transpose()) * *inverse);
}

std::vector<bool> SelectConsistentRays(std::span<const Ray> rays, bool moving) {
  std::vector<std::size_t> order(rays.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rays[i].time_s; });
  std::vector<bool> kept(rays.size(), false);
  std::vector<std::size_t> kept_indices;
  NormalEquations system(moving);
  for (const std::size_t i : order) {
    const NormalEquations before = system;
    system.Add(rays[i]);
    kept_indices.push_back(i);
    const auto motion = system.Solve();  // a singular system gives no reason to reject the ray
    if (motion && !std::ranges::all_of(kept_indices, [&](std::size_t k) { return InFrustum(rays[k], *motion); })) {
      system = before;
      kept_indices.pop_back();
      continue;
    }
    kept[i] = true;
  }
  return kept;
}

}  // namespace victorious
