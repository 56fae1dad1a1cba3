#include "victorious/geolocate/error_ellipse.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

using Eigen::Matrix2d;

TEST(CircularError, OfACircleIsRayleigh) {
  // 1 - exp(-r^2 / 2) = 0.9 at r = sqrt(2 ln 10).
  EXPECT_NEAR(CircularError(4 * Matrix2d::Identity(), 0.9), 2 * std::sqrt(2 * std::log(10.0)), 1e-9);
}

TEST(CircularError, OfALineIsNormal) {
  EXPECT_NEAR(CircularError(Eigen::Vector2d(9, 0).asDiagonal(), 0.9), 3 * 1.6448536, 1e-2);
}

TEST(CircularError, ContainsNominalFractionForAnyEllipse) {
  Random random(7);
  for (const double ratio : {0.05, 0.3, 0.7}) {
    Matrix2d root;
    root << 3, 1, 0, 3 * ratio;
    const double radius = CircularError(root * root.transpose(), 0.9);
    constexpr int kDraws = 40000;
    int inside = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = random.Normal();
      inside += (root * Eigen::Vector2d(x, random.Normal())).norm() <= radius ? 1 : 0;
    }
    EXPECT_NEAR(inside / static_cast<double>(kDraws), 0.9, 0.006) << ratio;
  }
}

TEST(LinearError90, IsTheNormalQuantile) { EXPECT_NEAR(LinearError90(4), 2 * 1.6448536, 1e-6); }

}  // namespace
}  // namespace victorious
