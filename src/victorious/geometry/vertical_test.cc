#include "victorious/geometry/vertical.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

TEST(Vertical, AtTheCentreMatchesTheAttitude) {
  // Looking 30 degrees down, the right side 10 degrees down: the line of sight is 60 degrees off nadir, and the
  // vertical leans to the left.
  const Vertical vertical =
      MakeVertical({RadiansFromDegrees(77), RadiansFromDegrees(-30), RadiansFromDegrees(10)}, 0.5, 640, 480);
  const Eigen::Vector3d expected = ViewUpVector(RadiansFromDegrees(60), RadiansFromDegrees(-10));
  EXPECT_LT((vertical.UpVectorAt({320, 240}) - expected).norm(), 1e-9);
}

TEST(Vertical, IsRadialInANadirImage) {
  const Vertical vertical = MakeVertical({0, -kPi / 2, 0}, 1.0, 640, 480);
  const Eigen::Vector3d seen =
      vertical.UpVectorAt({620, 240});  // the top of an upright object there appears farther right
  EXPECT_NEAR(seen.x(), std::sin(std::atan(300 / vertical.pinhole.fx)), 1e-9);
  EXPECT_NEAR(seen.y(), 0, 1e-9);
  EXPECT_LT(seen.z(), 0);
}

// Compares with the explicit rotation.
TEST(Vertical, RotatesByTheShortestArc) {
  const Vertical vertical = MakeVertical({1.0, -0.7, 0.2}, 0.9, 640, 480);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(3, 5), Eigen::Vector2d(600, 40), Eigen::Vector2d(100, 470)}) {
    const auto turn = Eigen::Quaterniond::FromTwoVectors(vertical.pinhole.Unproject(pixel), Eigen::Vector3d::UnitZ());
    EXPECT_LT((vertical.UpVectorAt(pixel) - turn * vertical.up_in_camera).norm(), 1e-9);
  }
}

// Compares with each line of sight's azimuth on Earth.
TEST(Vertical, GivesTheAzimuthOfEachLineOfSight) {
  for (const Attitude& attitude :
       {Attitude{1.0, -0.7, 0.2}, Attitude{-2.5, -1.4, 0}, Attitude{0.3, 0.1, -0.1}, Attitude{0.3, -kPi / 2, 0.1}}) {
    const Vertical vertical = MakeVertical(attitude, 1.2, 640, 480);
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(3, 5), Eigen::Vector2d(630, 240), Eigen::Vector2d(320, 240)}) {
      const Eigen::Vector3d enu = CameraFromEnu(attitude).conjugate() * vertical.pinhole.Unproject(pixel);
      const double expected = std::atan2(enu.x(), enu.y()) - attitude.yaw_rad;
      EXPECT_NEAR(WrapAngle(vertical.AzimuthAt(pixel) - expected), 0, 1e-9);
    }
  }
  const Vertical plumb = MakeVertical({1.0, -kPi / 2, 0}, 1.2, 640, 480);
  EXPECT_NEAR(plumb.AzimuthAt({630, 240}), kPi / 2, 1e-9);
  EXPECT_NEAR(plumb.AzimuthAt({320, 10}), 0, 1e-9);
}

}  // namespace
}  // namespace victorious
