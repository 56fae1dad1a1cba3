#include "victorious/geometry/angles.h"

#include <cmath>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(Angles, DegreesRadiansRoundTrip) {
  EXPECT_DOUBLE_EQ(DegreesFromRadians(kPi), 180.0);
  EXPECT_DOUBLE_EQ(RadiansFromDegrees(-90.0), -kPi / 2);
  for (double degrees = -720; degrees <= 720; degrees += 7) {
    EXPECT_NEAR(DegreesFromRadians(RadiansFromDegrees(degrees)), degrees, 1e-12);
  }
}

TEST(WrapAngle, KeepsDirectionWithinHalfATurn) {
  for (double angle_rad = -50; angle_rad <= 50; angle_rad += 0.37) {
    const double wrapped_rad = WrapAngle(angle_rad);
    EXPECT_LE(std::abs(wrapped_rad), kPi);
    EXPECT_NEAR(std::cos(wrapped_rad), std::cos(angle_rad), 1e-12);
    EXPECT_NEAR(std::sin(wrapped_rad), std::sin(angle_rad), 1e-12);
    EXPECT_DOUBLE_EQ(WrapAngle(wrapped_rad), wrapped_rad);
  }
}

TEST(WrapAngle, DifferenceIsTheSmallerAngle) {
  EXPECT_NEAR(WrapAngle(RadiansFromDegrees(179) - RadiansFromDegrees(-179)), RadiansFromDegrees(-2), 1e-12);
}

TEST(AngleBetween, IsTheSmallerAngleWithoutSign) {
  for (double a_rad = -kPi; a_rad <= kPi; a_rad += 0.1) {
    for (double b_rad = -kPi; b_rad <= kPi; b_rad += 0.1) {
      EXPECT_NEAR(AngleBetween(a_rad, b_rad), std::abs(WrapAngle(a_rad - b_rad)), 1e-12);
    }
  }
}

}  // namespace
}  // namespace victorious
