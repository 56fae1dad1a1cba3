#include "victorious/navigate/covariance.h"

#include <limits>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Factorisation of the correlation matrix: independent of units and of the magnitude of the variances.
struct Factors {
  Vector6 sigma_inverse;
  Eigen::LLT<Matrix6> correlation;
};

std::optional<Factors> Factorise(const Matrix6& covariance) {
  constexpr double kFloor = 1e-12;
  Factors factors;
  factors.sigma_inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!(covariance.diagonal().minCoeff() > 0) || !factors.sigma_inverse.allFinite()) return std::nullopt;
  Matrix6 correlation = factors.sigma_inverse.asDiagonal() * covariance * factors.sigma_inverse.asDiagonal();
  correlation.diagonal().array() += kFloor;
  if (!correlation.allFinite()) return std::nullopt;
  factors.correlation.compute(correlation);
  if (factors.correlation.info() != Eigen::Success) return std::nullopt;
  return factors;
}

}  // namespace

std::optional<Matrix6> InvertCovariance(const Matrix6& covariance) {
  const auto factors = Factorise(covariance);
  if (!factors) return std::nullopt;
  const Matrix6 scale = factors->sigma_inverse.asDiagonal();
  return scale * factors->correlation.solve(scale);
}

Matrix6 CovarianceFromInformation(const Matrix6& information) {
  constexpr double kPriorSigmaM = 1e4;
  Vector6 prior_variance;
  prior_variance << Eigen::Vector3d::Constant(kPi * kPi), Eigen::Vector3d::Constant(kPriorSigmaM * kPriorSigmaM);
  Matrix6 regular = information;
  regular.diagonal() += prior_variance.cwiseInverse();
  return InvertCovariance(regular).value_or(prior_variance.asDiagonal());
}

double SquaredMahalanobis(const Vector6& off, const Matrix6& covariance) {
  const auto factors = Factorise(covariance);
  if (!factors) return std::numeric_limits<double>::infinity();
  return factors->correlation.matrixL().solve(factors->sigma_inverse.cwiseProduct(off)).squaredNorm();
}

}  // namespace victorious
