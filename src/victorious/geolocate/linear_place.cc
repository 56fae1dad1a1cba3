#include "victorious/geolocate/linear_place.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

// Minimum pivot of a matrix with unit diagonal; below it the system is singular: lines parallel within 1e-6 rad.
constexpr double kLeastPivot = 1e-12;

// The factorised system, with its unknowns scaled to a unit diagonal: metres and metres per second become comparable.
struct Scaled {
  SmallVector scale;
  Eigen::LDLT<SmallMatrix> factors;
};

std::optional<Scaled> Factor(const SmallMatrix& matrix) {
  Scaled scaled;
  if (!(matrix.diagonal().minCoeff() > 0)) return std::nullopt;
  scaled.scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const SmallMatrix normalised = scaled.scale.asDiagonal() * matrix * scaled.scale.asDiagonal();
  scaled.factors.compute(normalised);
  if (scaled.factors.info() != Eigen::Success || !(scaled.factors.vectorD().minCoeff() > kLeastPivot))
    return std::nullopt;
  return scaled;
}

Matrix3d WeightOf(const Ray& ray) {
  return Matrix3d::Identity() - (1 - ray.range_weight) * ray.forward * ray.forward.transpose();
}

// Maps an error of the observed point to the point. If the range is from the ground, it changes with the ray such that
// the point stays on the ground.
Matrix3d PointFromError(const Ray& ray) {
  if (ray.range_source != RangeSource::kGround || ray.range_weight == 0) return Matrix3d::Identity();
  return Matrix3d::Identity() - ray.forward * ray.normal.transpose() / ray.forward.dot(ray.normal);
}

using OwnEffect = Eigen::Matrix<double, 3, 5>;

// Columns: displacement of the observed point by one sigma of each of the ray's own errors: east, north, up, side,
// rise.
OwnEffect OwnEffectOn(const Ray& ray, double distance_m, const LocateOptions& options) {
  OwnEffect effect;
  effect << options.line.position_m * Matrix3d::Identity(), distance_m * ray.sigma_rad * ray.side,
      distance_m * ray.sigma_rad * ray.rise;
  return PointFromError(ray) * effect;
}

Matrix3d RangeCovariance(const Ray& ray) {
  if (ray.range_source != RangeSource::kMeasured) return Matrix3d::Zero();
  return ray.sigma_range_m * ray.sigma_range_m * ray.forward * ray.forward.transpose();
}

using CommonEffect = Eigen::Matrix<double, 3, kCommonErrors + 1>;  // last column: the ground's height

// Columns: displacement of the observed point by one sigma of each common error.
CommonEffect CommonEffectOn(const Ray& ray, double distance_m, const LocateOptions& options) {
  CommonEffect effect = CommonEffect::Zero();
  effect.leftCols<3>() = Matrix3d::Identity();
  effect.col(3) = distance_m * ray.cos_elevation * ray.side;
  effect.col(4) = distance_m * ray.side;
  effect.col(5) = distance_m * ray.rise;
  effect.leftCols<kCommonErrors>() = PointFromError(ray) * effect.leftCols<kCommonErrors>();
  if (ray.range_source == RangeSource::kMeasured) effect.col(6) = ray.range_m * ray.forward;
  effect.leftCols<kCommonErrors>() *= CommonSigmas(options.common).asDiagonal();
  if (ray.range_source == RangeSource::kGround) {
    effect.col(kCommonErrors) = options.ground_sigma_m * ray.ground_share * ray.forward;
  }
  return effect;
}

// The fraction of the variance of the rays' own errors that is independent between rays, estimated from the rays'
// offsets from the object. The remainder is common to all rays: the errors of a stationary camera repeat in every
// frame.
double OwnShare(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& motion,
                const LocateOptions& options) {
  double squares = 0;
  double freedom = options.motion == "velocity" ? -6 : -3;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!chosen[i]) continue;
    const Vector3d seen = motion.At(rays[i].time_s) - rays[i].camera;
    const double along_m = seen.dot(rays[i].forward);
    const double off2 = (seen - along_m * rays[i].forward).squaredNorm();
    squares += off2 / (std::pow(along_m * rays[i].sigma_rad, 2) + std::pow(options.line.position_m, 2));
    freedom += 2;
  }
  return freedom > 0 ? std::min(1.0, squares / freedom) : 1;
}

// The transposed design matrix: derivative of the point at the ray's time by the unknowns, place then velocity.
MatrixXd TransposedDesign(const Ray& ray, Eigen::Index unknowns) {
  MatrixXd design(unknowns, 3);
  design.topRows<3>().setIdentity();
  if (unknowns == 6) design.bottomRows<3>() = ray.time_s * Matrix3d::Identity();
  return design;
}

}  // namespace

Eigen::Matrix<double, kCommonErrors, 1> CommonSigmas(const CommonErrorOptions& options) {
  Eigen::Matrix<double, kCommonErrors, 1> sigmas;
  sigmas << options.position_m, options.position_m, options.height_m, RadiansFromDegrees(options.heading_deg),
      RadiansFromDegrees(options.boresight_side_deg), RadiansFromDegrees(options.boresight_rise_deg),
      options.range_share;
  return sigmas;
}

void NormalSystem::Add(const Ray& ray, const Vector3d& along, double distance_m) {
  const Matrix3d weight = Matrix3d::Identity() - (1 - ray.range_weight) * along * along.transpose();
  const Vector3d across = ray.forward - along * along.dot(ray.forward);
  const Vector3d right = weight * ray.camera + distance_m * across + ray.range_weight * ray.range_m * along;
  AddWeight(weight, ray.time_s);
  right_.head<3>() += right;
  right_.tail<3>() += ray.time_s * right;
}

void NormalSystem::Discount(const Ray& ray, double variance) {
  AddWeight(-variance * (1 - ray.range_weight) * ray.forward * ray.forward.transpose(), ray.time_s);
}

void NormalSystem::AddWeight(const Matrix3d& weight, double time_s) {
  matrix_.topLeftCorner<3, 3>() += weight;
  if (unknowns_ == 3) return;
  matrix_.topRightCorner<3, 3>() += time_s * weight;
  matrix_.bottomLeftCorner<3, 3>() += time_s * weight;
  matrix_.bottomRightCorner<3, 3>() += time_s * time_s * weight;
}

void NormalSystem::Clear() {
  matrix_.setZero();
  right_.setZero();
}

std::optional<Motion> NormalSystem::Solve() const {
  const auto scaled = Factor(matrix_.topLeftCorner(unknowns_, unknowns_));
  if (!scaled) return std::nullopt;
  const SmallVector right = scaled->scale.cwiseProduct(right_.head(unknowns_));
  const SmallVector solution = scaled->scale.cwiseProduct(SmallVector(scaled->factors.solve(right)));
  if (!solution.allFinite()) return std::nullopt;
  Motion motion;
  motion.place = solution.head<3>();
  if (unknowns_ == 6) motion.velocity = solution.tail<3>();
  return motion;
}

std::optional<MatrixXd> NormalSystem::Inverse() const {
  const auto scaled = Factor(matrix_.topLeftCorner(unknowns_, unknowns_));
  if (!scaled) return std::nullopt;
  const SmallMatrix inverse = scaled->factors.solve(SmallMatrix::Identity(unknowns_, unknowns_));
  return MatrixXd(scaled->scale.asDiagonal() * inverse * scaled->scale.asDiagonal());
}

std::optional<Motion> SolveLinear(std::span<const Ray> rays, const std::vector<bool>& chosen, bool moving) {
  NormalSystem system(moving);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (chosen[i]) system.Add(rays[i]);
  }
  return system.Solve();
}

std::optional<Motion> SolveBalanced(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& start,
                                    const LocateOptions& options) {
  Motion motion = start;
  constexpr int kMostRounds = 10;
  for (int round = 0; round < kMostRounds; ++round) {
    NormalSystem system(options.motion == "velocity");
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!chosen[i]) continue;
      const Vector3d seen = motion.At(rays[i].time_s) - rays[i].camera;
      system.Add(rays[i], LikelyDirection(rays[i], rays[i].forward, seen, options.line.position_m), seen.norm());
    }
    const auto next = system.Solve();
    if (!next) return std::nullopt;
    constexpr double kSettledM = 1e-3;
    const bool settled = (next->place - motion.place).norm() < kSettledM;
    motion = *next;
    if (settled) break;
  }
  return motion;
}

std::optional<MatrixXd> LinearCovariance(std::span<const Ray> rays, const std::vector<bool>& chosen,
                                         const Motion& motion, const LocateOptions& options, bool as_one) {
  const bool moving = options.motion == "velocity";
  const Eigen::Index unknowns = moving ? 6 : 3;
  NormalSystem system(moving);
  const double feigned = FeignedFactor(std::ranges::count(chosen, true));
  const double own_share = as_one ? OwnShare(rays, chosen, motion, options) : 1;
  MatrixXd own = MatrixXd::Zero(unknowns, unknowns);
  MatrixXd alike = MatrixXd::Zero(unknowns, OwnEffect::ColsAtCompileTime);  // common part of the rays' own errors
  MatrixXd common = MatrixXd::Zero(unknowns, kCommonErrors + 1);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!chosen[i]) continue;
    const Ray& ray = rays[i];
    system.Add(ray);
    const double distance_m = (motion.At(ray.time_s) - ray.camera).norm();
    system.Discount(ray, feigned * ray.sigma_rad * ray.sigma_rad);
    const MatrixXd gain = TransposedDesign(ray, unknowns) * WeightOf(ray);
    const OwnEffect effect = OwnEffectOn(ray, distance_m, options);
    own += gain * (own_share * effect * effect.transpose() + RangeCovariance(ray)) * gain.transpose();
    alike += std::sqrt(1 - own_share) * gain * effect;
    common += gain * CommonEffectOn(ray, distance_m, options);
  }
  const auto inverse = system.Inverse();
  if (!inverse) return std::nullopt;
  return MatrixXd(*inverse * (own + alike * alike.transpose() + common * common.transpose()) * *inverse);
}

std::vector<bool> KeepWithinFrusta(std::span<const Ray> rays, bool moving) {
  std::vector<std::size_t> order(rays.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rays[i].time_s; });
  std::vector<bool> kept(rays.size(), false);
  std::vector<std::size_t> so_far;
  NormalSystem system(moving);
  for (const std::size_t i : order) {
    const NormalSystem before = system;
    system.Add(rays[i]);
    so_far.push_back(i);
    const auto motion = system.Solve();  // a singular system gives no reason to reject the ray
    if (motion && !std::ranges::all_of(so_far, [&](std::size_t k) { return InFrustum(rays[k], *motion); })) {
      system = before;
      so_far.pop_back();
      continue;
    }
    kept[i] = true;
  }
  return kept;
}

}  // namespace victorious
