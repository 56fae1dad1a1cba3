#include "victorious/observe/object_pose.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "testing/staged_sighting.h"
#include "victorious/geometry/view_sphere.h"

namespace victorious {
namespace {

const Eigen::Vector3d kPlaceEnu(40, 55, -100);

// Direction to the camera from an upright object at kPlaceEnu.
Eigen::Vector3d TrueDirection(double heading_deg) {
  const Eigen::AngleAxisd enu_from_model(kPi / 2 - RadiansFromDegrees(heading_deg), Eigen::Vector3d::UnitZ());
  return enu_from_model.inverse() * (-kPlaceEnu.normalized());
}

double ViewErrorDeg(const Stance& stance, const Eigen::Vector3d& truth) {
  const Eigen::Vector3d found = DirectionToCamera({stance.view->angles.azimuth_rad, stance.view->angles.off_nadir_rad});
  return DegreesFromRadians(std::acos(std::clamp(found.dot(truth), -1.0, 1.0)));
}

// Noise of keypoint positions.
void Blur(Staged& staged, double sigma_px, std::uint64_t seed) {
  Random random(seed);
  for (Keypoint& keypoint : staged.scene.keypoints) {
    keypoint.x += static_cast<float>(sigma_px * random.Normal());
    keypoint.y += static_cast<float>(sigma_px * random.Normal());
  }
}

std::optional<Stance> StanceOfStaged(const Staged& staged, const CameraState& camera) {
  return StanceOf(staged.detection, staged.model, staged.scene, camera, {}, UpInCamera(camera));
}

TEST(Stance, IsBetweenViews) {
  const CameraState camera = LookingDown(-55, 38);
  for (const double heading_deg : {10.0, 140.0, 265.0}) {
    const Staged staged = Stage(camera, kPlaceEnu, heading_deg, {});
    const auto stance = StanceOfStaged(staged, camera);
    ASSERT_TRUE(stance);
    EXPECT_LT(ViewErrorDeg(*stance, TrueDirection(heading_deg)), 0.7) << "the view that matched is 4 degrees off";
    EXPECT_NEAR(*stance->range_m, kPlaceEnu.norm(), 0.01 * kPlaceEnu.norm());
  }
}

TEST(Stance, ViewAndTurnTogetherAreTheRotation) {
  const CameraState camera = LookingDown(-55, 38);
  const auto stance = StanceOfStaged(Stage(camera, kPlaceEnu, 200, {}), camera);
  ASSERT_TRUE(stance);
  const Rigid3& stands = *stance->camera_from_object;
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), stands.translation.normalized()) *
      Eigen::AngleAxisd(stance->view->in_plane_rad, Eigen::Vector3d::UnitZ()) *
      CameraFromModel({stance->view->angles.azimuth_rad, stance->view->angles.off_nadir_rad});
  EXPECT_LT(turned.angularDistance(stands.rotation), 1e-6);
}

TEST(Stance, NeedsNoTelemetryWhereTheFieldOfViewIsKnown) {
  const CameraState camera = LookingDown(-55, 38);
  const Staged staged = Stage(camera, kPlaceEnu, 75, {});
  const auto stance = StanceOfStaged(staged, CameraState{.hfov_rad = camera.hfov_rad});
  ASSERT_TRUE(stance);
  EXPECT_LT(ViewErrorDeg(*stance, TrueDirection(75)), 1.5);
  EXPECT_NEAR(*stance->range_m, kPlaceEnu.norm(), 0.02 * kPlaceEnu.norm());
}

TEST(Stance, WithoutAFieldOfViewThereIsNoDistance) {
  const Staged staged = Stage(LookingDown(-55, 38), kPlaceEnu, 75, {});
  const auto stance = StanceOfStaged(staged, CameraState{});
  ASSERT_TRUE(stance);
  EXPECT_LT(ViewErrorDeg(*stance, TrueDirection(75)), 3);
  EXPECT_FALSE(stance->range_m);
}

TEST(Stance, WrongMatchesDoNotTiltIt) {
  const CameraState camera = LookingDown(-55, 38);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Staged staged = Stage(camera, kPlaceEnu, 75, {});
    Blur(staged, 0.5, seed);
    for (std::size_t i = 0; i < staged.scene.keypoints.size(); i += 3) {
      staged.scene.keypoints[i].x += 9;
      staged.scene.keypoints[i].y -= 7;
    }
    const auto stance = StanceOfStaged(staged, camera);
    ASSERT_TRUE(stance);
    EXPECT_LT(ViewErrorDeg(*stance, TrueDirection(75)), 4) << seed;
    EXPECT_NEAR(*stance->range_m, kPlaceEnu.norm(), 0.04 * kPlaceEnu.norm()) << seed;
  }
}

TEST(Stance, SaysHowFarItMayErr) {
  const CameraState camera = LookingDown(-55, 38);
  constexpr int kDraws = 100;
  int view_inside = 0;
  int distance_inside = 0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    Staged staged = Stage(camera, kPlaceEnu, 300, {});
    Blur(staged, 1, 50 + seed);
    const auto stance = StanceOfStaged(staged, camera);
    ASSERT_TRUE(stance);
    const double error_rad = RadiansFromDegrees(ViewErrorDeg(*stance, TrueDirection(300)));
    view_inside += error_rad < 2.15 * stance->view->sigma_rad ? 1 : 0;  // 90 % of a 2-D normal distribution
    distance_inside += std::abs(*stance->range_m - kPlaceEnu.norm()) < 1.64 * stance->sigma_range_m ? 1 : 0;
  }
  EXPECT_GE(view_inside, 80);
  EXPECT_GE(distance_inside, 80);
}

TEST(Stance, ErrsMoreTheLongerItIsOnlyFollowed) {
  Stance stance{.sigma_rad = 3e-4, .range_m = 100, .sigma_range_m = 0.3, .focal_px = 2000};
  const Stance before = stance;
  Age(stance, 0, {});
  EXPECT_EQ(stance.sigma_rad, before.sigma_rad);
  EXPECT_EQ(stance.sigma_range_m, before.sigma_range_m);
  Age(stance, 4, {.drift_px = 0.2, .drift_range_share = 0.001});
  EXPECT_NEAR(stance.sigma_rad, 5e-4, 1e-12) << "3 and 4";
  EXPECT_NEAR(stance.sigma_range_m, 0.5, 1e-12);
  EXPECT_EQ(stance.direction, before.direction);
  Stance without{.sigma_rad = 3e-4, .focal_px = 2000};
  Age(without, 4, {});
  EXPECT_FALSE(without.range_m);
}

TEST(Stance, AModelWithoutPointsHasNone) {
  Staged staged = Stage(LookingDown(-55, 38), kPlaceEnu, 75, {});
  staged.model.points_in_model = {};
  EXPECT_FALSE(StanceOfStaged(staged, LookingDown(-55, 38)));
  EXPECT_FALSE(StanceOfStaged(staged, CameraState{}));
}

TEST(Stance, OfABoxIsTheDirectionToItsMiddle) {
  const CameraState camera{.hfov_rad = kPi / 2};  // tan(hfov / 2) = 1
  const auto stance = StanceOfBox({300, 150, 100, 60}, {400, 300}, camera, {.category_centre_share = 0.1});
  ASSERT_TRUE(stance);
  EXPECT_TRUE(stance->direction.isApprox(Eigen::Vector3d(150, 30, 200).normalized(), 1e-9)) << stance->direction;
  EXPECT_NEAR(stance->sigma_rad, 10 / 200.0, 1e-3);
  EXPECT_FALSE(stance->range_m);
  EXPECT_FALSE(StanceOfBox({300, 150, 100, 60}, {400, 300}, {}, {}));
}

}  // namespace
}  // namespace victorious
