#include "victorious/place/observe/box_bearing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const GeodeticPoint kOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};
const cv::Size kImage(640, 480);

// A camera that looks at the origin, but for the given offset in pitch.
CameraState CameraAt(const Vector3d& place, double pitch_offset_rad = 0) {
  return {.time_s = 0,
          .place = TangentPlane(kOrigin).GeodeticFromEnu(place),
          .attitude =
              Attitude{std::atan2(-place.x(), -place.y()), std::asin(-place.z() / place.norm()) + pitch_offset_rad, 0},
          .hfov_rad = RadiansFromDegrees(20)};
}

double FocalPx() { return 320 / std::tan(RadiansFromDegrees(10)); }

TEST(BoxBearing, PassesThroughTheBoxCentre) {
  const auto observation = MakeBoxBearingObservation({300, 220, 40, 40}, kImage, CameraAt({0, -70, 70}), nullptr, 7);
  ASSERT_TRUE(observation);
  EXPECT_NEAR(observation->line.azimuth_rad, 0, 1e-4);
  EXPECT_NEAR(observation->line.elevation_rad, -kPi / 4, 1e-4);
  EXPECT_NEAR(*observation->line.sigma_rad, kBoxCentreFraction * 40 / FocalPx(), 1e-5);
  EXPECT_FALSE(observation->line.range_m);
  EXPECT_EQ(observation->recognition_id, 7);
}

TEST(BoxBearing, ObjectTypeLengthGivesRange) {
  const ObjectType* car = FindObjectType("car");
  const CameraState camera = CameraAt({0, -70, 70});
  const auto observation = MakeBoxBearingObservation({300, 220, 40, 40}, kImage, camera, car, 1);
  ASSERT_TRUE(observation && observation->line.range_m);
  EXPECT_NEAR(*observation->line.range_m, FocalPx() * kBoxLengthRatio * car->length_m / 40, 1e-6);
  EXPECT_FALSE(MakeBoxBearingObservation({0, 220, 40, 40}, kImage, camera, car, 1)->line.range_m)
      << "it may extend outside the frame";
  EXPECT_FALSE(MakeBoxBearingObservation({300, 220, 40, 40}, kImage, {}, car, 1)) << "no camera state";
}

TEST(BoxBearing, PredictedBoxMatchesPlaceAndDistance) {
  const CameraState before = CameraAt({-60, -70, 100}, 0.005);
  CameraState near = CameraAt({0, -35, 50});
  const auto seen = PredictBox(kOrigin, {300, 200, 30, 20}, before, near, kImage);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->box.x + seen->box.width / 2, 320, 0.01);
  EXPECT_NEAR(seen->box.y + seen->box.height / 2, 240, 0.01);
  EXPECT_NEAR(seen->box.width, 30 * Vector3d(-60, -70, 100).norm() / Vector3d(0, -35, 50).norm(), 0.3);
  near.attitude->pitch_rad = 1;
  EXPECT_FALSE(PredictBox(kOrigin, {300, 200, 30, 20}, before, near, kImage)) << "behind the camera";
  near.hfov_rad.reset();
  EXPECT_FALSE(PredictBox(kOrigin, {300, 200, 30, 20}, before, near, kImage));
}

}  // namespace
}  // namespace victorious
