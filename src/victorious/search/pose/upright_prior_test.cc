#include "victorious/search/pose/upright_prior.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr double kTilt_rad = 0.35;
const Eigen::Vector2d kMiddle_px(320, 240);

TEST(UprightPrior, AssumesAnUprightCamera) {
  const UprightPrior aslant = UprightPrior::AssumingUprightCamera(RadiansFromDegrees(60), kTilt_rad);
  EXPECT_TRUE(aslant.IsAllowed(kMiddle_px, 0));
  EXPECT_TRUE(aslant.IsAllowed(kMiddle_px, RadiansFromDegrees(90)));
  EXPECT_TRUE(aslant.IsAllowed(kMiddle_px, RadiansFromDegrees(-110)));
  EXPECT_FALSE(aslant.IsAllowed(kMiddle_px, RadiansFromDegrees(120)));
  EXPECT_FALSE(aslant.IsAllowed(kMiddle_px, RadiansFromDegrees(-175)));
  EXPECT_NEAR(aslant.SearchReductionDecades(), std::log10(180 / 113.3), 0.001);
}

TEST(UprightPrior, NadirViewsAllowAnyRotation) {
  const UprightPrior from_above = UprightPrior::AssumingUprightCamera(RadiansFromDegrees(20), kTilt_rad);
  EXPECT_TRUE(from_above.IsAllowed(kMiddle_px, RadiansFromDegrees(180)));
  EXPECT_EQ(from_above.SearchReductionDecades(), 0);
  const UprightPrior held_any_way = UprightPrior::AssumingUprightCamera(RadiansFromDegrees(60), kPi / 2);
  EXPECT_TRUE(held_any_way.IsAllowed(kMiddle_px, RadiansFromDegrees(180)));
  EXPECT_EQ(held_any_way.SearchReductionDecades(), 0);
}

TEST(UprightPrior, UsesTheGivenVertical) {
  const double off_nadir_rad = RadiansFromDegrees(60);
  const double roll_rad = RadiansFromDegrees(30);
  const Vertical rolled = MakeVertical({0, off_nadir_rad - kPi / 2, roll_rad}, 0.3, 640, 480);
  const UprightPrior measured = UprightPrior::FromVertical(rolled, off_nadir_rad, kTilt_rad);
  EXPECT_TRUE(measured.IsAllowed(kMiddle_px, -roll_rad));
  EXPECT_FALSE(measured.IsAllowed(kMiddle_px, roll_rad));
  EXPECT_FALSE(measured.IsAllowed(kMiddle_px, kPi));
  EXPECT_NEAR(measured.SearchReductionDecades(), 1.52, 0.01);
}

// The bound holds for the lines of sight of the image's middle column, and is reached by one of them.
TEST(UprightPrior, BoundsTheTurnFromTheLean) {
  for (const double camera_deg : {35.0, 60.0, 85.0}) {
    for (const double hfov_rad : {0.2, 1.2}) {
      const Vertical vertical = MakeVertical({0.4, RadiansFromDegrees(camera_deg) - kPi / 2, 0.3}, hfov_rad, 640, 480);
      for (const double off_nadir_deg : {10.0, 30.0, 50.0, 80.0}) {
        const UprightPrior prior = UprightPrior::FromVertical(vertical, RadiansFromDegrees(off_nadir_deg), kTilt_rad);
        double min_ray_rad = kPi;
        double max_ray_rad = 0;
        double widest_rad = 0;
        for (double y = 0; y <= 480; y += 10) {
          const double ray_rad = std::acos(-vertical.UpVectorAt({320, y}).z());
          min_ray_rad = std::min(min_ray_rad, ray_rad);
          max_ray_rad = std::max(max_ray_rad, ray_rad);
          for (double turn_rad = -kPi; turn_rad < kPi; turn_rad += 0.005) {
            if (!prior.IsAllowed({320, y}, turn_rad)) continue;
            widest_rad = std::max(widest_rad, std::abs(WrapAngle(turn_rad - vertical.LeanAt({320, y}))));
          }
        }
        const double bound_rad = prior.MaxTurnFromLean(min_ray_rad, max_ray_rad);
        EXPECT_LE(widest_rad, bound_rad) << camera_deg << " " << hfov_rad << " " << off_nadir_deg;
        EXPECT_GT(widest_rad, bound_rad - 0.03) << camera_deg << " " << hfov_rad << " " << off_nadir_deg;
      }
    }
  }
  const Vertical vertical = MakeVertical({0, RadiansFromDegrees(10) - kPi / 2, 0}, 0.3, 640, 480);
  EXPECT_EQ(UprightPrior::FromVertical(vertical, RadiansFromDegrees(60), 3.2).MaxTurnFromLean(0, 1), kPi);
}

TEST(UprightPrior, BoundsTheTurnOfAnUnknownAttitude) {
  const UprightPrior aslant = UprightPrior::AssumingUprightCamera(RadiansFromDegrees(60), kTilt_rad);
  const double bound_rad = aslant.MaxTurnFromLean(0, kPi);
  EXPECT_TRUE(aslant.IsAllowed(kMiddle_px, bound_rad - 0.001));
  EXPECT_FALSE(aslant.IsAllowed(kMiddle_px, bound_rad + 0.001));
  EXPECT_EQ(UprightPrior::AssumingUprightCamera(RadiansFromDegrees(15), kTilt_rad).MaxTurnFromLean(0, kPi), kPi);
}

}  // namespace
}  // namespace victorious
