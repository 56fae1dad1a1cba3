#include "victorious/search/follow/image_motion.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr double kDiagonal_px = 500;
const cv::Size kSize{400, 300};

TEST(FractionMoved, IsThatOfTheFarthestCorner) {
  EXPECT_EQ(FractionMoved({}, kSize), 0);
  EXPECT_NEAR(FractionMoved({.translation = {30, 40}}, kSize), 50 / kDiagonal_px, 1e-12);
  EXPECT_NEAR(FractionMoved({.scale = 1.2}, kSize), 0.2, 1e-12);
}

TEST(FractionMoved, CountsTurnsOfTheImage) {
  const Similarity2 half_turn{.rotation_rad = kPi, .translation = {kSize.width, kSize.height}};
  EXPECT_NEAR(FractionMoved(half_turn, kSize), 1, 1e-12) << "corners change places, the centre stays";
}

}  // namespace
}  // namespace victorious
