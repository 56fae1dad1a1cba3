#include "victorious/geometry/view_direction.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

TEST(ViewDirection, FollowsTheContract) {
  const auto direction = [](double azimuth_deg, double off_nadir_deg) {
    return DirectionToCamera({RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(off_nadir_deg)});
  };
  EXPECT_LT((direction(0, 90) - Vector3d(-1, 0, 0)).norm(), 1e-12);   // behind it
  EXPECT_LT((direction(90, 90) - Vector3d(0, 1, 0)).norm(), 1e-12);   // on its left
  EXPECT_LT((direction(180, 90) - Vector3d(1, 0, 0)).norm(), 1e-12);  // in front
  EXPECT_LT((direction(123, 0) - Vector3d(0, 0, 1)).norm(), 1e-12);   // above
}

TEST(ViewDirection, VectorsAndAnglesAreInverse) {
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    const ViewDirection direction{random.Uniform(0, 2 * kPi), random.Uniform(0.01, kPi - 0.01)};
    const ViewDirection back = DirectionFromVector(3.0 * DirectionToCamera(direction));
    EXPECT_NEAR(back.azimuth_rad, direction.azimuth_rad, 1e-9);
    EXPECT_NEAR(back.off_nadir_rad, direction.off_nadir_rad, 1e-9);
  }
}

TEST(ViewDirection, AnglesBetweenDirections) {
  const ViewDirection above{.azimuth_rad = 2, .off_nadir_rad = 0};
  EXPECT_EQ(AngleBetween(above, above), 0);
  EXPECT_NEAR(AngleBetween(above, {.azimuth_rad = 1, .off_nadir_rad = 0.7}), 0.7, 1e-12);
  EXPECT_NEAR(AngleBetween(ViewDirection{0, 0.3}, ViewDirection{kPi, 0.4}), 0.7, 1e-12);
  EXPECT_NEAR(AngleBetween(Vector3d(2, 0, 0), Vector3d(-1, 0, 0)), kPi, 1e-12);
}

}  // namespace
}  // namespace victorious
