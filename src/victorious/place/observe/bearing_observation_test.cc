#include "victorious/place/observe/bearing_observation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "testing/synthetic_sighting.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {
namespace {

using testing::kFocalPx;
using testing::kHeight;
using testing::kWidth;
using testing::LookingDown;
using testing::MakeSyntheticSighting;
using testing::SyntheticSighting;

std::optional<BearingObservation> Observe(const SyntheticSighting& sighting, const CameraState& camera) {
  const auto object_pose =
      EstimateObjectPose(sighting.detection, sighting.model, sighting.scene, camera, {}, UpInCamera(camera));
  return object_pose ? MakeBearingObservation(*object_pose, camera) : std::nullopt;
}

void ExpectObservation(const std::optional<BearingObservation>& observation, const Eigen::Vector3d& object_enu,
                       double heading_deg) {
  ASSERT_TRUE(observation);
  const double off_deg = 0.02;
  EXPECT_NEAR(DegreesFromRadians(WrapAngle(observation->line.azimuth_rad - std::atan2(object_enu.x(), object_enu.y()))),
              0, off_deg);
  EXPECT_NEAR(DegreesFromRadians(observation->line.elevation_rad - std::asin(object_enu.normalized().z())), 0, off_deg);
  EXPECT_NEAR(*observation->line.range_m, object_enu.norm(), 0.01 * object_enu.norm());
  EXPECT_LT(*observation->line.sigma_range_m, 0.1 * object_enu.norm());
  EXPECT_NEAR(DegreesFromRadians(WrapAngle(*observation->heading_rad - RadiansFromDegrees(heading_deg))), 0, 3);
}

TEST(BearingObservation, MatchesBearingRangeAndHeadingOfAKnownObject) {
  const Eigen::Vector3d object_enu(40, 55, -100);
  const CameraState camera = LookingDown(-55, 38);
  for (const double heading_deg : {10.0, 140.0, 265.0}) {
    const SyntheticSighting sighting = MakeSyntheticSighting(camera, object_enu, heading_deg, {});
    const auto observation = Observe(sighting, camera);
    ExpectObservation(observation, object_enu, heading_deg);
    EXPECT_EQ(observation->line.camera, camera.place);
    EXPECT_EQ(observation->line.time_s, 2);
  }
}

// The line of the camera moved and turned by the error, less that of the camera.
TEST(BearingObservation, ErrorsOfTheClockShiftTheLine) {
  const Eigen::Vector3d object_enu(40, 55, -100);
  CameraState camera = LookingDown(-55, 38);
  const SyntheticSighting sighting = MakeSyntheticSighting(camera, object_enu, 140, {});
  EXPECT_FALSE(Observe(sighting, camera)->line.clock_shift);
  camera.clock_error = ClockError{.moved_enu_m = {3, -2, 0.5}, .turned_enu_rad = {0.002, -0.001, 0.003}};
  const auto observation = Observe(sighting, camera);
  ASSERT_TRUE(observation->line.clock_shift);
  const ClockShift& shift = *observation->line.clock_shift;
  EXPECT_EQ(shift.camera_enu_m, camera.clock_error->moved_enu_m);
  const Eigen::Vector3d turned = camera.clock_error->turned_enu_rad;
  CameraState later = camera;
  later.attitude =
      AttitudeFromRotation(CameraFromEnu(*camera.attitude) *
                           Eigen::Quaterniond(Eigen::AngleAxisd(turned.norm(), turned.normalized())).conjugate());
  const auto after = Observe(sighting, later);
  EXPECT_NEAR(shift.azimuth_rad, WrapAngle(after->line.azimuth_rad - observation->line.azimuth_rad), 1e-4);
  EXPECT_NEAR(shift.elevation_rad, after->line.elevation_rad - observation->line.elevation_rad, 1e-4);
}

// The line and the range of a camera of longer focal length, less those of the camera.
TEST(BearingObservation, ErrorsOfTheFocalLengthShiftTheLine) {
  CameraState camera = LookingDown(-55, 38);
  const SyntheticSighting sighting = MakeSyntheticSighting(camera, {47, 55, -100}, 140, {});
  EXPECT_FALSE(Observe(sighting, camera)->line.focal_shift);
  camera.sigma_focal = 0.02;
  const auto observation = Observe(sighting, camera);
  ASSERT_TRUE(observation->line.focal_shift);
  const FocalShift& shift = *observation->line.focal_shift;
  EXPECT_EQ(shift.sigma, 0.02);
  CameraState longer = camera;
  longer.hfov_rad = 2 * std::atan(std::tan(*camera.hfov_rad / 2) * std::exp(-0.02));
  const auto after = Observe(sighting, longer);
  EXPECT_GT(std::abs(shift.azimuth_rad), 1e-4);
  EXPECT_GT(std::abs(shift.elevation_rad), 1e-4);
  EXPECT_NEAR(shift.azimuth_rad, WrapAngle(after->line.azimuth_rad - observation->line.azimuth_rad), 5e-5);
  EXPECT_NEAR(shift.elevation_rad, after->line.elevation_rad - observation->line.elevation_rad, 5e-5);
  EXPECT_NEAR(*after->line.range_m / *observation->line.range_m, 1.02, 0.003);
}

TEST(BearingObservation, LensDistortionIsRemoved) {
  const Eigen::Vector3d object_enu(47, 60, -100);
  CameraState camera = LookingDown(-55, 38);
  camera.distortion = LensDistortion{-2.5, 8, 0.01, -0.02, 0};
  const SyntheticSighting sighting = MakeSyntheticSighting(camera, object_enu, 140, *camera.distortion);
  ExpectObservation(Observe(sighting, camera), object_enu, 140);
}

TEST(BearingObservation, IncompleteCameraStateGivesNone) {
  CameraState camera = LookingDown(-55, 38);
  const SyntheticSighting sighting = MakeSyntheticSighting(camera, {40, 55, -100}, 10, {});
  camera.hfov_rad.reset();
  EXPECT_FALSE(Observe(sighting, camera));
}

TEST(BearingObservation, PhotoModelHasARangeOnlyWithKnownLength) {
  ObjectModel model{.kind = ModelKind::kPhotos};
  model.views.push_back({.width = 200, .height = 100, .outline = {{0, 0}, {200, 0}, {200, 100}, {0, 100}}});
  Detection detection;
  detection.fit.scene_from_template = {0.5, 0, {270, 215}};
  detection.fit.scene_from_template_plane = detection.fit.scene_from_template.Matrix();
  FeatureSet scene;
  scene.image_width = kWidth;
  scene.image_height = kHeight;
  const CameraState camera = LookingDown(-90, 0);
  auto observation = MakeBearingObservation(EstimateObjectPose(detection, model, scene, camera, {}).value(), camera);
  ASSERT_TRUE(observation);
  EXPECT_FALSE(observation->line.range_m);
  EXPECT_FALSE(observation->heading_rad);
  EXPECT_NEAR(DegreesFromRadians(observation->line.elevation_rad), -90, 1.3);  // (320, 240) up to 50 px, 1.2 degrees
  model.length_m = 4;
  observation = MakeBearingObservation(EstimateObjectPose(detection, model, scene, camera, {}).value(), camera);
  EXPECT_NEAR(*observation->line.range_m, kFocalPx * 4 / 100, 1e-6);
}

}  // namespace
}  // namespace victorious
