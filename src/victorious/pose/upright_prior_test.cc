#include "victorious/pose/upright_prior.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr double kTilt_rad = 0.35;
const Eigen::Vector2d kMiddle_px(320, 240);

TEST(UprightPrior, SupposesThatNobodyFilmsUpsideDown) {
  const UprightPrior aslant = UprightPrior::Supposed(RadiansFromDegrees(60), kTilt_rad);
  EXPECT_TRUE(aslant.Allows(kMiddle_px, 0));
  EXPECT_TRUE(aslant.Allows(kMiddle_px, RadiansFromDegrees(90)));
  EXPECT_TRUE(aslant.Allows(kMiddle_px, RadiansFromDegrees(-110)));
  EXPECT_FALSE(aslant.Allows(kMiddle_px, RadiansFromDegrees(120)));
  EXPECT_FALSE(aslant.Allows(kMiddle_px, RadiansFromDegrees(-175)));
  EXPECT_NEAR(aslant.Decades(), std::log10(180 / 113.3), 0.001);
}

TEST(UprightPrior, LetsWhatIsSeenFromAboveLieInAnyWay) {
  const UprightPrior from_above = UprightPrior::Supposed(RadiansFromDegrees(20), kTilt_rad);
  EXPECT_TRUE(from_above.Allows(kMiddle_px, RadiansFromDegrees(180)));
  EXPECT_EQ(from_above.Decades(), 0);
  const UprightPrior held_any_way = UprightPrior::Supposed(RadiansFromDegrees(60), kPi / 2);
  EXPECT_TRUE(held_any_way.Allows(kMiddle_px, RadiansFromDegrees(180)));
  EXPECT_EQ(held_any_way.Decades(), 0);
}

TEST(UprightPrior, KeepsToTheVerticalThatIsTold) {
  const double off_nadir_rad = RadiansFromDegrees(60);
  const double roll_rad = RadiansFromDegrees(30);
  const Vertical rolled = MakeVertical({0, off_nadir_rad - kPi / 2, roll_rad}, 0.3, 640, 480);
  const UprightPrior told = UprightPrior::Told(rolled, off_nadir_rad, kTilt_rad);
  EXPECT_TRUE(told.Allows(kMiddle_px, -roll_rad));
  EXPECT_FALSE(told.Allows(kMiddle_px, roll_rad));
  EXPECT_FALSE(told.Allows(kMiddle_px, kPi));
  EXPECT_NEAR(told.Decades(), 1.52, 0.01);
}

}  // namespace
}  // namespace victorious
