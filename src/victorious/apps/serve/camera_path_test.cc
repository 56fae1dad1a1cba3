#include "victorious/apps/serve/camera_path.h"

#include <gtest/gtest.h>

#include "victorious/apps/serve/api_json.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

CameraState LookingDown(double yaw_deg) {
  return {.time_s = 1,
          .place = {RadiansFromDegrees(52), RadiansFromDegrees(13), 150},
          .attitude = Attitude{RadiansFromDegrees(yaw_deg), RadiansFromDegrees(-90), 0},
          .hfov_rad = RadiansFromDegrees(90)};
}

TEST(Footprint, OfACameraThatLooksDownIsARectangleBelowIt) {
  const CameraState camera = LookingDown(0);
  const auto footprint = ComputeFootprint(camera, 640, 480, 50);
  ASSERT_TRUE(footprint);
  const TangentPlane plane({camera.place.latitude_rad, camera.place.longitude_rad, 50});
  // 100 m above the ground, 90 degrees wide: 200 m by 150 m; the image's upper edge is north.
  const std::array<Eigen::Vector2d, 4> expected = {Eigen::Vector2d(-100, 75), {100, 75}, {100, -75}, {-100, -75}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner = plane.EnuFromGeodetic((*footprint)[i]);
    EXPECT_NEAR(corner.x(), expected[i].x(), 0.01) << i;
    EXPECT_NEAR(corner.y(), expected[i].y(), 0.01) << i;
  }
}

TEST(Footprint, TurnsWithTheCamera) {
  const auto footprint = ComputeFootprint(LookingDown(90), 640, 480, 50);
  ASSERT_TRUE(footprint);
  const TangentPlane plane({RadiansFromDegrees(52), RadiansFromDegrees(13), 50});
  const Eigen::Vector3d left_top = plane.EnuFromGeodetic((*footprint)[0]);
  EXPECT_NEAR(left_top.x(), 75, 0.01);  // the upper edge is east
  EXPECT_NEAR(left_top.y(), 100, 0.01);
}

TEST(Footprint, IsUnknownAtTheHorizonAndForIncompleteStates) {
  CameraState level = LookingDown(0);
  level.attitude->pitch_rad = 0;
  EXPECT_FALSE(ComputeFootprint(level, 640, 480, 50));
  CameraState wide = LookingDown(0);
  wide.hfov_rad.reset();
  EXPECT_FALSE(ComputeFootprint(wide, 640, 480, 50));
  EXPECT_FALSE(ComputeFootprint(LookingDown(0), 640, 480, 500)) << "below the ground";
}

TEST(CameraPath, IsThinnedWithItsEnds) {
  std::vector<CameraState> states;
  for (int i = 0; i <= 1000; ++i) states.push_back({.time_s = 0.1 * i, .place = {}});
  const auto thinned = ThinStates(states, 11);
  ASSERT_EQ(thinned.size(), 11U);
  EXPECT_EQ(thinned.front().time_s, 0);
  EXPECT_NEAR(thinned[1].time_s, 10, 0.11);
  EXPECT_NEAR(thinned.back().time_s, 100, 1e-9);
  EXPECT_EQ(ThinStates(states, 5000).size(), states.size());
}

TEST(CameraPath, SaysWhyItHasNoFootprint) {
  EXPECT_NE(MakeCameraPath({LookingDown(0)}, CameraPathSource::kTelemetry, 640, 480, std::nullopt).reason, "");
  EXPECT_EQ(MakeCameraPath({LookingDown(0)}, CameraPathSource::kTelemetry, 640, 480, 50).reason, "");
}

TEST(EllipseAxes, AreThoseOfTheCovariance) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance.diagonal() << 1, 4, 9;  // north is longer
  const EllipseAxes north = ComputeEllipseAxes(covariance);
  EXPECT_NEAR(north.semi_major_m, 2 * 2.14597, 1e-4);
  EXPECT_NEAR(north.semi_minor_m, 2.14597, 1e-4);
  EXPECT_NEAR(std::sin(north.azimuth_rad), 0, 1e-9);
  covariance << 2.5, 1.5, 0, 1.5, 2.5, 0, 0, 0, 1;  // north-east
  EXPECT_NEAR(ComputeEllipseAxes(covariance).azimuth_rad, kPi / 4, 1e-9);
}

}  // namespace
}  // namespace victorious
