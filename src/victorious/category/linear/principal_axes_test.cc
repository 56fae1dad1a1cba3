#include "victorious/category/linear/principal_axes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

TEST(PrincipalAxes, MatchAxesOfAnEllipsoid) {
  // Independent coordinates with standard deviations 1, 3 and 0.2 about (5, 0, -2), turned by 30 degrees in the first
  // two.
  Random random(2);
  Eigen::MatrixXf columns(3, 20000);
  const float c = std::sqrt(0.75F);
  for (auto column : columns.colwise()) {
    const auto a = static_cast<float>(random.Normal());
    const auto b = static_cast<float>(3 * random.Normal());
    column << 5 + c * a - 0.5F * b, 0.5F * a + c * b, static_cast<float>(-2 + 0.2 * random.Normal());
  }
  const PrincipalAxes axes = FitPrincipalAxes(columns);
  EXPECT_LT((axes.mean - Eigen::Vector3f(5, 0, -2)).norm(), 0.1);
  EXPECT_NEAR(std::sqrt(axes.variance(0)), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(axes.variance(1)), 1, 0.03);
  EXPECT_NEAR(std::sqrt(axes.variance(2)), 3, 0.1);
  EXPECT_LT((axes.axes.transpose() * axes.axes - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  const Eigen::MatrixXd largest = axes.Largest(1);
  ASSERT_EQ(largest.rows(), 1);
  EXPECT_NEAR(std::abs(largest(0, 0)), 0.5, 0.02);
  EXPECT_NEAR(std::abs(largest(0, 1)), std::sqrt(0.75), 0.02);
}

}  // namespace
}  // namespace victorious
