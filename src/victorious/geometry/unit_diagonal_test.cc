#include "victorious/geometry/unit_diagonal.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(UnitDiagonal, IsTheCorrelationOfACovariance) {
  Eigen::Matrix2d covariance;
  covariance << 4, 0.6, 0.6, 0.25;
  const auto scaled = ScaleToUnitDiagonal(covariance);
  ASSERT_TRUE(scaled);
  EXPECT_NEAR(scaled->matrix(0, 0), 1, 1e-15);
  EXPECT_NEAR(scaled->matrix(1, 1), 1, 1e-15);
  EXPECT_NEAR(scaled->matrix(0, 1), 0.6, 1e-15);
  EXPECT_NEAR(scaled->scale.x(), 0.5, 1e-15);
}

TEST(UnitDiagonal, RequiresPositiveVariances) {
  EXPECT_FALSE(ScaleToUnitDiagonal(Eigen::Matrix2d(Eigen::Matrix2d::Zero())));
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_TRUE(ScaleToUnitDiagonal(matrix));
  matrix(1, 1) = -1;
  EXPECT_FALSE(ScaleToUnitDiagonal(matrix));
  matrix(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(ScaleToUnitDiagonal(matrix));
}

}  // namespace
}  // namespace victorious
