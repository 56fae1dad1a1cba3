#include "victorious/geometry/lens.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(Lens, ZeroDistortionIsIdentity) {
  const Eigen::Vector2d point(0.3, -0.2);
  EXPECT_EQ(Distort(point, {}), point);
  EXPECT_EQ(Undistort(point, {}), point);
}

TEST(Lens, BarrelDistortionMovesPointsInwards) {
  EXPECT_NEAR(Distort({0.5, 0}, {-0.1, 0, 0, 0, 0}).x(), 0.5 * (1 - 0.1 * 0.25), 1e-15);
  EXPECT_NEAR(Distort({0, 0.5}, {0, 0, 0.01, 0, 0}).y(), 0.5 + 3 * 0.01 * 0.25, 1e-15);
}

TEST(Lens, UndistortInvertsDistort) {
  const LensDistortion lens = {-0.28, 0.11, 0.0007, -0.0004, -0.02};
  for (double x = -0.6; x <= 0.6; x += 0.2) {
    for (double y = -0.45; y <= 0.45; y += 0.15) {
      EXPECT_LT((Undistort(Distort({x, y}, lens), lens) - Eigen::Vector2d(x, y)).norm(), 1e-9) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace victorious
