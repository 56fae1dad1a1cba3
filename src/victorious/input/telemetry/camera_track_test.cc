#include "victorious/input/telemetry/camera_track.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

CameraState StateAt(double time_s, double longitude_deg, double yaw_deg) {
  CameraState state{.time_s = time_s, .place = {0.5, RadiansFromDegrees(longitude_deg), 100 + 10 * time_s}};
  state.attitude = Attitude{RadiansFromDegrees(yaw_deg), -0.7, 0};
  state.hfov_rad = 0.5;
  return state;
}

TEST(CameraTrajectory, InterpolatesPositionLinearlyAndAttitudeOnTheSphere) {
  const CameraTrajectory track({StateAt(1, 10.002, 10), StateAt(0, 10.000, 350)}, 2);
  const auto middle = track.At(0.5);
  ASSERT_TRUE(middle && middle->attitude);
  EXPECT_NEAR(DegreesFromRadians(middle->place.longitude_rad), 10.001, 1e-9);
  EXPECT_NEAR(middle->place.altitude_m, 105, 1e-9);
  EXPECT_NEAR(WrapAngle(middle->attitude->yaw_rad), 0, 1e-9) << "the smaller angle, through north";
  EXPECT_EQ(track.At(1)->time_s, 1);
}

TEST(CameraTrajectory, InterpolatesAcrossTheDateLine) {
  const CameraTrajectory track({StateAt(0, 179.9, 0), StateAt(1, -179.9, 0)}, 2);
  EXPECT_NEAR(std::abs(DegreesFromRadians(track.At(0.5)->place.longitude_rad)), 180, 1e-9);
}

TEST(CameraTrajectory, NoStateInGapsAndBeyondTheEnds) {
  const CameraTrajectory track({StateAt(0, 10, 0), StateAt(1, 10, 0), StateAt(9, 10, 0)}, 2);
  EXPECT_FALSE(track.At(5));
  EXPECT_FALSE(track.At(-0.5));
  EXPECT_FALSE(track.At(9.5));
  EXPECT_TRUE(track.At(9.05)) << "time stamps of frames and packets seldom coincide";
  EXPECT_FALSE(CameraTrajectory({}, 2).At(0));
  EXPECT_FALSE(track.At(std::numeric_limits<double>::quiet_NaN()));
}

TEST(CameraTrajectory, WithoutAGapStatesHoldAtTheirTimesOnly) {
  const CameraTrajectory track({StateAt(0, 10, 0), StateAt(0.1, 10, 0)}, 0);
  EXPECT_TRUE(track.At(0));
  EXPECT_TRUE(track.At(0.1));
  EXPECT_FALSE(track.At(0.05));
  EXPECT_FALSE(track.At(0.15));
  EXPECT_FALSE(track.At(-0.01));
}

TEST(CameraTrajectory, FieldMissingInOneNeighbourIsUnknown) {
  CameraState bare = StateAt(1, 10, 0);
  bare.attitude.reset();
  const CameraTrajectory track({StateAt(0, 10, 0), bare}, 2);
  ASSERT_TRUE(track.At(0.5));
  EXPECT_FALSE(track.At(0.5)->attitude);
  EXPECT_TRUE(track.At(0.5)->hfov_rad);
}

}  // namespace
}  // namespace victorious
