#include "victorious/geometry/attitude.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const Vector3d kEast = Vector3d::UnitX();
const Vector3d kNorth = Vector3d::UnitY();
const Vector3d kUp = Vector3d::UnitZ();

Attitude Degrees(double yaw, double pitch, double roll) {
  return {RadiansFromDegrees(yaw), RadiansFromDegrees(pitch), RadiansFromDegrees(roll)};
}

TEST(Attitude, LevelCameraLooksNorth) {
  const Eigen::Quaterniond camera_from_enu = CameraFromEnu({});
  EXPECT_LT((camera_from_enu * kNorth - Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((camera_from_enu * kEast - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((camera_from_enu * kUp - Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST(Attitude, YawIsClockwisePitchUpAndRollRightSideDown) {
  EXPECT_LT((CameraFromEnu(Degrees(90, 0, 0)) * kEast - Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((CameraFromEnu(Degrees(0, 90, 0)) * kUp - Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((CameraFromEnu(Degrees(90, -90, 0)) * -kUp - Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((CameraFromEnu(Degrees(90, -90, 0)) * kEast - Vector3d(0, -1, 0)).norm(), 1e-12);
  const Vector3d right_in_enu = CameraFromEnu(Degrees(0, 0, 30)).conjugate() * Vector3d(1, 0, 0);
  EXPECT_NEAR(right_in_enu.z(), -0.5, 1e-12);
}

TEST(Attitude, RoundTrips) {
  Random random(17);
  for (int i = 0; i < 200; ++i) {
    const Attitude attitude = Degrees(random.Uniform(0, 360), random.Uniform(-89, 89), random.Uniform(-180, 180));
    const Attitude back = AttitudeFromRotation(CameraFromEnu(attitude));
    EXPECT_NEAR(WrapAngle(back.yaw_rad - attitude.yaw_rad), 0, 1e-9);
    EXPECT_NEAR(back.pitch_rad, attitude.pitch_rad, 1e-9);
    EXPECT_NEAR(WrapAngle(back.roll_rad - attitude.roll_rad), 0, 1e-9);
  }
}

TEST(Attitude, NadirHasZeroRoll) {
  const Eigen::Quaterniond camera_from_enu = CameraFromEnu(Degrees(40, -90, 25));
  const Attitude attitude = AttitudeFromRotation(camera_from_enu);
  EXPECT_EQ(attitude.roll_rad, 0);
  EXPECT_LT(CameraFromEnu(attitude).angularDistance(camera_from_enu), 1e-6);
}

}  // namespace
}  // namespace victorious
