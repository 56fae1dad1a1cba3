#include "victorious/apps/decoder/crop.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(CropRegion, ContainsTheBoxInsideTheFrame) {
  const Box region = CropRegion({10, 10, 100, 60}, 640, 480);
  EXPECT_NEAR(region.width / region.height, 4.0 / 3, 1e-9);
  EXPECT_EQ(region.x, 0);
  EXPECT_GE(region.width, 150);
  const Box at_corner = CropRegion({600, 450, 40, 30}, 640, 480);
  EXPECT_LE(at_corner.x + at_corner.width, 640);
  EXPECT_LE(at_corner.y + at_corner.height, 480);
  EXPECT_EQ(CropRegion({5, 5, 2, 2}, 640, 480).height, 48) << "a small object is not magnified without end";
  EXPECT_LT(CropRegion({0, 0, 640, 480}, 640, 480).x, 0) << "the whole frame, with a border";
}

}  // namespace
}  // namespace victorious
