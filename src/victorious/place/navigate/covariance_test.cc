#include "victorious/place/navigate/covariance.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace victorious {
namespace {

// Radians and metres, of very different magnitudes.
Matrix6 MakeCovariance() {
  Matrix6 root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = std::sin(1.0 + 7 * i * i) * (i < 18 ? 1e-4 : 1e3);
  return root * root.transpose();
}

TEST(Covariance, InverseTimesMatrixIsIdentity) {
  const Matrix6 covariance = MakeCovariance();
  const auto inverse = InvertCovariance(covariance);
  ASSERT_TRUE(inverse);
  const Vector6 sigma = covariance.diagonal().cwiseSqrt();  // normalises to the same magnitude
  const Matrix6 product = sigma.cwiseInverse().asDiagonal() * covariance * *inverse * sigma.asDiagonal();
  EXPECT_TRUE(product.isApprox(Matrix6::Identity(), 1e-6)) << product;
  const Vector6 off = covariance * Vector6::LinSpaced(-1, 2);
  EXPECT_NEAR(SquaredMahalanobis(off, covariance) / off.dot(*inverse * off), 1, 1e-6);
}

TEST(Covariance, IndefiniteMatrixHasInfiniteDistance) {
  const Vector6 off = Vector6::Ones();
  Matrix6 negative = Matrix6::Identity();
  negative(2, 2) = -1;
  Matrix6 impossible = Matrix6::Identity();
  impossible(0, 1) = impossible(1, 0) = 2;
  for (const Matrix6& matrix : {Matrix6(Matrix6::Zero()), negative, impossible,
                                Matrix6(Matrix6::Constant(std::numeric_limits<double>::quiet_NaN()))}) {
    EXPECT_FALSE(InvertCovariance(matrix));
    EXPECT_EQ(SquaredMahalanobis(off, matrix), std::numeric_limits<double>::infinity());
  }
}

TEST(Covariance, FullyCorrelatedMatrixIsInvertible) {
  const Matrix6 alike = Matrix6::Constant(1e12);
  EXPECT_TRUE(InvertCovariance(alike));
  EXPECT_NEAR(SquaredMahalanobis(Vector6::Constant(1e6), alike), 1, 1e-3);
}

}  // namespace
}  // namespace victorious
