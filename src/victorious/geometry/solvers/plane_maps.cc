#include "victorious/geometry/solvers/plane_maps.h"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace victorious {
namespace {

// Normalises points: weighted mean to the origin, weighted mean distance to sqrt(2).
Eigen::Matrix3d Normalizer(std::span<const PointPair> pairs, std::span<const double> weights,
                           Eigen::Vector2d PointPair::* side) {
  double total = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    total += weight;
    mean += weight * (pairs[i].*side);
  }
  mean /= total;
  double distance = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    distance += (weights.empty() ? 1.0 : weights[i]) * (pairs[i].*side - mean).norm();
  }
  const double scale = std::numbers::sqrt2 * total / distance;
  Eigen::Matrix3d normalizer = Eigen::Matrix3d::Identity() * scale;
  normalizer(2, 2) = 1;
  normalizer.topRightCorner<2, 1>() = -scale * mean;
  return normalizer;
}

// Minimum ratio of the smallest to the largest eigenvalue of a normal matrix: the squared ratio of the singular values.
constexpr double kMinConditioning = 1e-10;

}  // namespace

std::optional<Eigen::Matrix3d> SolveAffine(std::span<const PointPair> pairs, std::span<const double> weights) {
  if (pairs.size() < 3) return std::nullopt;
  const Eigen::Matrix3d from = Normalizer(pairs, weights, &PointPair::source);
  if (!from.allFinite()) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    const Eigen::Vector3d source = from * pairs[i].source.homogeneous();
    normal += weight * source * source.transpose();
    right += weight * source * pairs[i].target.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum(normal);
  if (!(spectrum.eigenvalues()(0) > kMinConditioning * spectrum.eigenvalues()(2))) return std::nullopt;
  Eigen::Matrix3d affine = Eigen::Matrix3d::Identity();
  affine.topRows<2>() = normal.ldlt().solve(right).transpose();
  affine *= from;
  if (!affine.allFinite()) return std::nullopt;
  return affine;
}

std::optional<Eigen::Matrix3d> SolveHomography(std::span<const PointPair> pairs, std::span<const double> weights) {
  if (pairs.size() < 4) return std::nullopt;
  const Eigen::Matrix3d from = Normalizer(pairs, weights, &PointPair::source);
  const Eigen::Matrix3d to = Normalizer(pairs, weights, &PointPair::target);
  if (!from.allFinite() || !to.allFinite()) return std::nullopt;
  using Matrix9 = Eigen::Matrix<double, 9, 9>;
  using Vector9 = Eigen::Matrix<double, 9, 1>;
  Matrix9 normal = Matrix9::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    const Eigen::Vector3d source = from * pairs[i].source.homogeneous();
    const Eigen::Vector2d target = (to * pairs[i].target.homogeneous()).hnormalized();
    Vector9 row_x = Vector9::Zero();
    Vector9 row_y = Vector9::Zero();
    row_x.segment<3>(0) = source;
    row_x.segment<3>(6) = -target.x() * source;
    row_y.segment<3>(3) = source;
    row_y.segment<3>(6) = -target.y() * source;
    normal += weight * (row_x * row_x.transpose() + row_y * row_y.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9> spectrum(normal);
  // A second small eigenvalue means that the points do not determine the homography.
  if (!(spectrum.eigenvalues()(1) > kMinConditioning * spectrum.eigenvalues()(8))) return std::nullopt;
  const Vector9 h = spectrum.eigenvectors().col(0);
  Eigen::Matrix3d homography;
  homography << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
  homography = to.inverse() * homography * from;
  if (std::abs(homography(2, 2)) < 1e-12 * homography.norm()) return std::nullopt;
  homography /= homography(2, 2);
  if (!homography.allFinite()) return std::nullopt;
  return homography;
}

}  // namespace victorious
