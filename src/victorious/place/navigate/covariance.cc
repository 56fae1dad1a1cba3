#include "victorious/place/navigate/covariance.h"

#include <limits>

#include <Eigen/Cholesky>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/unit_diagonal.h"

namespace victorious {
namespace {

// Factorisation of the correlation matrix: independent of units and of the magnitude of the variances.
struct Factors {
  Vector6 sigma_inverse;
  Eigen::LLT<Matrix6> correlation;
};

std::optional<Factors> Factorise(const Matrix6& covariance) {
  constexpr double kFloor = 1e-12;  // reduces correlations numerically equal to 1
  auto scaled = ScaleToUnitDiagonal(covariance);
  if (!scaled) return std::nullopt;
  scaled->matrix.diagonal().array() += kFloor;
  Factors factors{.sigma_inverse = scaled->scale, .correlation = {}};
  factors.correlation.compute(scaled->matrix);
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
  constexpr double kPriorSigma_m = 1e4;
  Vector6 prior_variance;
  prior_variance << Eigen::Vector3d::Constant(kPi * kPi), Eigen::Vector3d::Constant(kPriorSigma_m * kPriorSigma_m);
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
