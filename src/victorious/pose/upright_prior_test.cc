#include "victorious/pose/upright_prior.h"

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

}  // namespace
}  // namespace victorious
