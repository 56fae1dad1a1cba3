#include "victorious/geometry/homography.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

const Matrix3d kTilt = (Matrix3d() << 1, 0, 0, 0, 1, 0, 0.01, 0, 1).finished();

TEST(ApplyHomography, DividesByThirdCoordinate) {
  EXPECT_TRUE(ApplyHomography(kTilt, {100, 50}).isApprox(Vector2d(50, 25), 1e-12));
  EXPECT_TRUE(ApplyHomography(Matrix3d::Identity(), {7, -3}).isApprox(Vector2d(7, -3), 1e-12));
}

TEST(ApplyHomography, IsInvariantToMatrixScale) {
  EXPECT_TRUE(ApplyHomography(-3 * kTilt, {20, 30}).isApprox(ApplyHomography(kTilt, {20, 30}), 1e-12));
}

TEST(ApplyHomography, PointsOnTheHorizonAreNotFinite) { EXPECT_FALSE(ApplyHomography(kTilt, {-100, 5}).allFinite()); }

TEST(ApplyHomography, ComposesAndInverts) {
  Random random(1);
  const auto random_matrix = [&] {
    Matrix3d matrix = Matrix3d::Identity();
    for (int i = 0; i < 6; ++i) matrix(i / 3, i % 3) += random.Uniform(-0.3, 0.3);
    matrix(2, 0) = random.Uniform(-1e-3, 1e-3);
    matrix(2, 1) = random.Uniform(-1e-3, 1e-3);
    return matrix;
  };
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Matrix3d c_from_b = random_matrix();
    const Matrix3d b_from_a = random_matrix();
    const Vector2d point(random.Uniform(-100, 100), random.Uniform(-100, 100));
    const Vector2d stepwise = ApplyHomography(c_from_b, ApplyHomography(b_from_a, point));
    EXPECT_LT((ApplyHomography(c_from_b * b_from_a, point) - stepwise).norm(), 1e-9);
    EXPECT_LT((ApplyHomography(b_from_a.inverse(), ApplyHomography(b_from_a, point)) - point).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace victorious
