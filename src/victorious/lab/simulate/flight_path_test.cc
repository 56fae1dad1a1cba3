#include "victorious/lab/simulate/flight_path.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kSeed = 3;

SceneCamera StraightFlight() {
  SceneCamera camera;
  camera.aim_m = {{-40, 10}, {60, 20}};
  camera.from_deg = {200};
  camera.off_nadir_deg = {35};
  camera.range_m = {120};
  camera.roll_deg = {5};
  return camera;
}

// The point where the optical axis meets the ground.
Vector2d AimOf(const Rigid3& camera_from_town) {
  const Rigid3 town_from_camera = camera_from_town.Inverse();
  const Vector3d axis = town_from_camera.rotation * Vector3d::UnitZ();
  const Vector3d place = town_from_camera.translation;
  return (place - axis * (place.z() / axis.z())).head<2>();
}

TEST(FlightPath, LooksAtTheAimFromTheGivenDirection) {
  for (const double fraction : {0.0, 0.25, 1.0}) {
    const Rigid3 camera_from_town = CameraFromTown(StraightFlight(), fraction, 0, kSeed);
    const Vector2d aim = Vector2d(-40, 10) + fraction * Vector2d(100, 10);
    EXPECT_LT((AimOf(camera_from_town) - aim).norm(), 1e-9);
    const Vector3d to_camera = camera_from_town.Inverse().translation - Vector3d(aim.x(), aim.y(), 0);
    EXPECT_NEAR(to_camera.norm(), 120, 1e-9);
    EXPECT_NEAR(to_camera.z() / 120, std::cos(RadiansFromDegrees(35)), 1e-12);
    EXPECT_NEAR(std::atan2(to_camera.x(), to_camera.y()), RadiansFromDegrees(200 - 360), 1e-12);
  }
}

TEST(FlightPath, PositiveRollLowersTheCamerasRightSide) {
  const Rigid3 camera_from_town = CameraFromTown(StraightFlight(), 0, 0, kSeed);
  const double lowered = std::sin(RadiansFromDegrees(5)) * std::sin(RadiansFromDegrees(35));
  EXPECT_NEAR((camera_from_town.rotation.conjugate() * Vector3d::UnitX()).z(), -lowered, 1e-9);
}

TEST(FlightPath, CirclesAboutAFixedAim) {
  SceneCamera camera;
  camera.from_deg = {0, 360};
  const Vector3d start = CameraFromTown(camera, 0, 0, kSeed).Inverse().translation;
  const Vector3d opposite = CameraFromTown(camera, 0.5, 0, kSeed).Inverse().translation;
  const Vector3d end = CameraFromTown(camera, 1, 0, kSeed).Inverse().translation;
  EXPECT_LT((start.head<2>() + opposite.head<2>()).norm(), 1e-9);
  EXPECT_LT((start - end).norm(), 1e-9);
}

TEST(FlightPath, SmoothPassesThroughKnotsWithContinuousVelocity) {
  SceneCamera camera;
  camera.path = PathInterpolation::kSmooth;
  camera.aim_m = {{0, 0}, {10, 0}, {10, 10}};
  EXPECT_LT((AimOf(CameraFromTown(camera, 0.5, 0, kSeed)) - Vector2d(10, 0)).norm(), 1e-9);
  const auto step = [&](double from, double to) {
    return Vector2d((AimOf(CameraFromTown(camera, to, 0, kSeed)) - AimOf(CameraFromTown(camera, from, 0, kSeed))) /
                    (to - from));
  };
  EXPECT_LT((step(0.4999, 0.5) - step(0.5, 0.5001)).norm(), 0.05);
}

// Between two knots at the limit of the range, a spline through lower neighbours overshoots the limit.
TEST(FlightPath, SmoothStaysWithinLimits) {
  SceneCamera camera;
  camera.path = PathInterpolation::kSmooth;
  camera.off_nadir_deg = {0, 80, 80, 0, 0, 80};
  camera.range_m = {10000, 1, 1, 10000, 10000, 1};
  camera.from_deg = {180};
  double min_deg = 90;
  double max_deg = -90;
  for (int i = 0; i <= 200; ++i) {
    const Vector3d place = CameraFromTown(camera, i / 200.0, 0, kSeed).Inverse().translation;
    const double range_m = place.norm();  // the aim is the origin
    EXPECT_GE(range_m, 1 - 1e-9);
    EXPECT_LE(range_m, 10000 + 1e-6);
    const double off_nadir_deg = DegreesFromRadians(std::atan2(-place.y(), place.z()));  // the camera is behind
    EXPECT_GE(off_nadir_deg, -1e-9) << i;
    EXPECT_LE(off_nadir_deg, 80 + 1e-9) << i;
    min_deg = std::min(min_deg, off_nadir_deg);
    max_deg = std::max(max_deg, off_nadir_deg);
  }
  EXPECT_NEAR(min_deg, 0, 1e-6);
  EXPECT_NEAR(max_deg, 80, 1e-6);
}

TEST(FlightPath, ShakeHasTheGivenSigmaAndIsDeterministic) {
  SceneCamera camera = StraightFlight();
  const Rigid3 still = CameraFromTown(camera, 0.3, 0, kSeed);
  camera.shake_deg = 0.5;
  double squares = 0;
  constexpr int kSamples = 3000;
  for (int i = 0; i < kSamples; ++i) {
    const Rigid3 shaken = CameraFromTown(camera, 0.3, i * 0.0371, kSeed);
    squares += std::pow(DegreesFromRadians(shaken.rotation.angularDistance(still.rotation)), 2);
    EXPECT_LT((shaken.Inverse().translation - still.Inverse().translation).norm(), 1e-9);
  }
  EXPECT_NEAR(std::sqrt(squares / kSamples / 3), 0.5, 0.03);  // about each of three axes
  EXPECT_EQ(CameraFromTown(camera, 0.3, 1.7, kSeed).rotation, CameraFromTown(camera, 0.3, 1.7, kSeed).rotation);
  EXPECT_GT(CameraFromTown(camera, 0.3, 1.7, kSeed)
                .rotation.angularDistance(CameraFromTown(camera, 0.3, 1.7, kSeed + 1).rotation),
            1e-4);
}

TEST(FlightPath, PinholeHasTheFieldOfView) {
  const PinholeCamera pinhole = MakePinhole({.width = 640, .height = 480, .hfov_deg = 90});
  EXPECT_NEAR(pinhole.fx, 320, 1e-9);
  EXPECT_EQ(pinhole.cy, 240);
}

SceneObject Driver() {
  SceneObject object;
  object.path_m = {{0, 0}, {0, 40}, {40, 40}};
  object.speed_m_s = 10;
  return object;
}

TEST(GroundPose, StaticObjectHasTheGivenPose) {
  SceneObject object;
  object.x_m = 3;
  object.y_m = -4;
  object.heading_deg = 90;
  const GroundPose pose = ComputeGroundPose(object, 4, 12);
  EXPECT_EQ(pose.place_m, Vector2d(3, -4));
  EXPECT_NEAR(pose.heading_rad, kPi / 2, 1e-12);
}

TEST(GroundPose, FollowsTheRouteToItsEnd) {
  const GroundPose start = ComputeGroundPose(Driver(), 4, 0);
  EXPECT_LT(start.place_m.norm(), 1e-9);
  EXPECT_NEAR(start.heading_rad, 0, 1e-12);
  EXPECT_LT((ComputeGroundPose(Driver(), 4, 2).place_m - Vector2d(0, 20)).norm(), 1e-9);
  EXPECT_NEAR(ComputeGroundPose(Driver(), 4, 4).heading_rad, kPi / 4, 1e-9);  // half round
  EXPECT_NEAR(ComputeGroundPose(Driver(), 4, 6).heading_rad, kPi / 2, 1e-9);
  EXPECT_LT((ComputeGroundPose(Driver(), 4, 100).place_m - Vector2d(40, 40)).norm(), 1e-9);
}

// Rests for 2 s, drives, and rests for 3 s at the corner.
TEST(GroundPose, PathWithTimesStartsFromRestAndStops) {
  SceneObject object = Driver();
  object.speed_m_s = 0;
  object.path_m = {{0, 0}, {0, 0}, {0, 40}, {0, 40}, {40, 40}};
  object.times_s = {0, 2, 10, 13, 20};
  const auto place = [&](double time_s) { return ComputeGroundPose(object, 4, time_s).place_m; };
  const auto speed = [&](double time_s) { return ComputeGroundVelocity(object, 4, time_s).norm(); };
  EXPECT_LT(place(-1).norm(), 1e-9);
  EXPECT_LT(place(2).norm(), 1e-9);
  EXPECT_EQ(speed(1), 0);
  EXPECT_LT((place(10) - place(12.9)).norm(), 1e-9);
  EXPECT_EQ(speed(11), 0);
  EXPECT_LT((place(20) - Vector2d(40, 40)).norm(), 1e-9);
  EXPECT_NEAR(speed(6), 1.5 * 40 / 8, 1e-6) << "from rest to rest, at most 1.5 times the mean";
  double fastest_change = 0;
  for (double time_s = 0; time_s < 19.9; time_s += 0.01) {
    if (time_s > 8.5 && time_s < 14.5) continue;  // around the corner
    fastest_change = std::max(fastest_change, std::abs(speed(time_s + 0.01) - speed(time_s)));
  }
  EXPECT_LT(fastest_change, 0.08) << "the speed is continuous";
}

TEST(GroundPose, EquidistantTimesGiveConstantSpeed) {
  SceneObject object = Driver();
  object.speed_m_s = 0;
  object.times_s = {0, 4, 8};
  for (double time_s = 0.1; time_s < 8; time_s += 0.3) {
    EXPECT_LT((ComputeGroundPose(object, 4, time_s).place_m - ComputeGroundPose(Driver(), 4, time_s).place_m).norm(),
              1e-9)
        << time_s;
  }
}

TEST(GroundPose, DuplicateRoutePointsChangeNothing) {
  SceneObject twice = Driver();
  twice.path_m = {{0, 0}, {0, 0}, {0, 40}, {0, 40}, {40, 40}, {40, 40}, {40, 40}};
  for (double time_s = 0; time_s < 12; time_s += 0.3) {
    const GroundPose expected = ComputeGroundPose(Driver(), 4, time_s);
    const GroundPose pose = ComputeGroundPose(twice, 4, time_s);
    EXPECT_LT((pose.place_m - expected.place_m).norm(), 1e-9) << time_s;
    EXPECT_NEAR(pose.heading_rad, expected.heading_rad, 1e-9) << time_s;
  }
}

}  // namespace
}  // namespace victorious
