#include "victorious/place/observe/object_pose.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "testing/synthetic_sighting.h"
#include "victorious/base/random.h"
#include "victorious/geometry/view_direction.h"

namespace victorious {
namespace {

using testing::LookingDown;
using testing::MakeSyntheticSighting;
using testing::SyntheticSighting;

const Eigen::Vector3d kPlaceEnu(40, 55, -100);

// Direction to the camera from an upright object at kPlaceEnu.
Eigen::Vector3d TrueDirection(double heading_deg) {
  const Eigen::AngleAxisd enu_from_model(kPi / 2 - RadiansFromDegrees(heading_deg), Eigen::Vector3d::UnitZ());
  return enu_from_model.inverse() * (-kPlaceEnu.normalized());
}

double ViewErrorDeg(const ObjectPose& object_pose, const Eigen::Vector3d& truth) {
  const Eigen::Vector3d found = DirectionToCamera(object_pose.view->angles);
  return DegreesFromRadians(std::acos(std::clamp(found.dot(truth), -1.0, 1.0)));
}

// Noise of keypoint positions.
void Blur(SyntheticSighting& sighting, double sigma_px, std::uint64_t seed) {
  Random random(seed);
  for (Keypoint& keypoint : sighting.scene.keypoints) {
    keypoint.x += static_cast<float>(sigma_px * random.Normal());
    keypoint.y += static_cast<float>(sigma_px * random.Normal());
  }
}

std::optional<ObjectPose> EstimatePose(const SyntheticSighting& sighting, const CameraState& camera) {
  return EstimateObjectPose(sighting.detection, sighting.model, sighting.scene, camera, {}, UpInCamera(camera));
}

TEST(ObjectPose, InterpolatesBetweenViews) {
  const CameraState camera = LookingDown(-55, 38);
  for (const double heading_deg : {10.0, 140.0, 265.0}) {
    const SyntheticSighting sighting = MakeSyntheticSighting(camera, kPlaceEnu, heading_deg, {});
    const auto object_pose = EstimatePose(sighting, camera);
    ASSERT_TRUE(object_pose);
    EXPECT_LT(ViewErrorDeg(*object_pose, TrueDirection(heading_deg)), 0.7) << "the view that matched is 4 degrees off";
    EXPECT_NEAR(*object_pose->range_m, kPlaceEnu.norm(), 0.01 * kPlaceEnu.norm());
  }
}

TEST(ObjectPose, ViewAndInPlaneRotationGiveTheRotation) {
  const CameraState camera = LookingDown(-55, 38);
  const auto object_pose = EstimatePose(MakeSyntheticSighting(camera, kPlaceEnu, 200, {}), camera);
  ASSERT_TRUE(object_pose);
  const Rigid3& stands = *object_pose->camera_from_object;
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), stands.translation.normalized()) *
      Eigen::AngleAxisd(object_pose->view->in_plane_rad, Eigen::Vector3d::UnitZ()) *
      CameraFromModel(object_pose->view->angles);
  EXPECT_LT(turned.angularDistance(stands.rotation), 1e-6);
}

TEST(ObjectPose, NeedsOnlyTheFieldOfView) {
  const CameraState camera = LookingDown(-55, 38);
  const SyntheticSighting sighting = MakeSyntheticSighting(camera, kPlaceEnu, 75, {});
  const auto object_pose = EstimatePose(sighting, CameraState{.hfov_rad = camera.hfov_rad});
  ASSERT_TRUE(object_pose);
  EXPECT_LT(ViewErrorDeg(*object_pose, TrueDirection(75)), 1.5);
  EXPECT_NEAR(*object_pose->range_m, kPlaceEnu.norm(), 0.02 * kPlaceEnu.norm());
}

TEST(ObjectPose, MissingFieldOfViewGivesNoRange) {
  const SyntheticSighting sighting = MakeSyntheticSighting(LookingDown(-55, 38), kPlaceEnu, 75, {});
  const auto object_pose = EstimatePose(sighting, CameraState{});
  ASSERT_TRUE(object_pose);
  EXPECT_LT(ViewErrorDeg(*object_pose, TrueDirection(75)), 3);
  EXPECT_FALSE(object_pose->range_m);
}

TEST(ObjectPose, IsRobustToFalseMatches) {
  const CameraState camera = LookingDown(-55, 38);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SyntheticSighting sighting = MakeSyntheticSighting(camera, kPlaceEnu, 75, {});
    Blur(sighting, 0.5, seed);
    for (std::size_t i = 0; i < sighting.scene.keypoints.size(); i += 3) {
      sighting.scene.keypoints[i].x += 9;
      sighting.scene.keypoints[i].y -= 7;
    }
    const auto object_pose = EstimatePose(sighting, camera);
    ASSERT_TRUE(object_pose);
    EXPECT_LT(ViewErrorDeg(*object_pose, TrueDirection(75)), 4) << seed;
    EXPECT_NEAR(*object_pose->range_m, kPlaceEnu.norm(), 0.04 * kPlaceEnu.norm()) << seed;
  }
}

TEST(ObjectPose, CovarianceIsConsistent) {
  const CameraState camera = LookingDown(-55, 38);
  constexpr int kDraws = 100;
  int view_inside = 0;
  int distance_inside = 0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    SyntheticSighting sighting = MakeSyntheticSighting(camera, kPlaceEnu, 300, {});
    Blur(sighting, 1, 50 + seed);
    const auto object_pose = EstimatePose(sighting, camera);
    ASSERT_TRUE(object_pose);
    const double error_rad = RadiansFromDegrees(ViewErrorDeg(*object_pose, TrueDirection(300)));
    view_inside += error_rad < 2.15 * object_pose->view->sigma_rad ? 1 : 0;  // 90 % of a 2-D normal distribution
    distance_inside += std::abs(*object_pose->range_m - kPlaceEnu.norm()) < 1.64 * object_pose->sigma_range_m ? 1 : 0;
  }
  EXPECT_GE(view_inside, 80);
  EXPECT_GE(distance_inside, 80);
}

TEST(ObjectPose, TrackingDriftGrowsWithFrames) {
  ObjectPose object_pose{.sigma_rad = 3e-4, .range_m = 100, .sigma_range_m = 0.3, .focal_px = 2000};
  const ObjectPose before = object_pose;
  AddTrackingDrift(object_pose, 0, {});
  EXPECT_EQ(object_pose.sigma_rad, before.sigma_rad);
  EXPECT_EQ(object_pose.sigma_range_m, before.sigma_range_m);
  AddTrackingDrift(object_pose, 4, {.drift_px = 0.2, .drift_range_fraction = 0.001});
  EXPECT_NEAR(object_pose.sigma_rad, 5e-4, 1e-12) << "3 and 4";
  EXPECT_NEAR(object_pose.sigma_range_m, 0.5, 1e-12);
  EXPECT_EQ(object_pose.direction, before.direction);
  ObjectPose without{.sigma_rad = 3e-4, .focal_px = 2000};
  AddTrackingDrift(without, 4, {});
  EXPECT_FALSE(without.range_m);
}

TEST(ObjectPose, ModelWithoutPointsHasNoPose) {
  SyntheticSighting sighting = MakeSyntheticSighting(LookingDown(-55, 38), kPlaceEnu, 75, {});
  for (FitInlier& inlier : sighting.detection.fit.inliers) inlier.point_in_model.reset();
  EXPECT_FALSE(EstimatePose(sighting, LookingDown(-55, 38)));
  EXPECT_FALSE(EstimatePose(sighting, CameraState{}));
}

TEST(ObjectPose, BoxGivesDirectionToItsCentre) {
  const CameraState camera{.hfov_rad = kPi / 2};  // tan(hfov / 2) = 1
  const auto object_pose = EstimateBoxDirection({300, 150, 100, 60}, {400, 300}, camera, 0.1);
  ASSERT_TRUE(object_pose);
  EXPECT_TRUE(object_pose->direction.isApprox(Eigen::Vector3d(150, 30, 200).normalized(), 1e-9))
      << object_pose->direction;
  EXPECT_NEAR(object_pose->sigma_rad, 10 / 200.0, 1e-3);
  EXPECT_FALSE(object_pose->range_m);
  EXPECT_FALSE(EstimateBoxDirection({300, 150, 100, 60}, {400, 300}, {}, 0.1));
}

}  // namespace
}  // namespace victorious
