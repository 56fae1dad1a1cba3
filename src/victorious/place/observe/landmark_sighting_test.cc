#include "victorious/place/observe/landmark_sighting.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr double kNarrowFocalPx = 2300;
constexpr double kRangeM = 120;

Rigid3 Truth() { return {RotationFromVector(Vector3d(0.9, -0.4, 0.3)), Vector3d(6, -4, kRangeM)}; }

// A pose from some points, each with a noise of one pixel along each axis.
ObjectPose RandomObjectPose(Random& random, int count) {
  ObjectPose object_pose{.focal_px = kNarrowFocalPx};
  for (int i = 0; i < count; ++i) {
    const Vector3d point(random.Uniform(-3, 3), random.Uniform(-1.5, 1.5), random.Uniform(-1, 1));
    const Vector3d p = Truth().Apply(point);
    const Eigen::Vector2d noise(random.Normal(), random.Normal());
    object_pose.points.push_back({point, p.head<2>() / p.z() + noise / kNarrowFocalPx});
  }
  const auto pose = FitObjectPose(object_pose.points, Truth().rotation,
                                  {.sigma = 1 / kNarrowFocalPx, .sigma_view_rad = RadiansFromDegrees(6)});
  object_pose.camera_from_object = pose->camera_from_object;
  object_pose.range_m = pose->camera_from_object.translation.norm();
  object_pose.direction = pose->camera_from_object.translation / *object_pose.range_m;
  return object_pose;
}

Vector6 ErrorOf(const LandmarkSighting& sighting) {
  Vector6 error;
  error << VectorFromRotation(Truth().rotation * sighting.camera_from_landmark.rotation.conjugate()),
      Truth().translation - sighting.camera_from_landmark.translation;
  return error;
}

TEST(LandmarkSighting, InformationIsConsistentWithErrors) {
  Random random(11);
  ObservationOptions options;
  options.point_sigma_px = 1;
  options.min_sigma_px = 0;
  options.min_range_fraction = 0;
  double sum = 0;
  constexpr int kDraws = 200;
  for (int i = 0; i < kDraws; ++i) {
    const auto sighting = MakeLandmarkSighting(RandomObjectPose(random, 40), options,
                                               {.min_rotation_sigma_deg = 0, .reference_points = 0});
    ASSERT_TRUE(sighting);
    sum += ErrorOf(*sighting).dot(sighting->information * ErrorOf(*sighting));
  }
  EXPECT_GT(sum / kDraws, 4);  // 6 degrees of freedom; the matched view was exact, which the estimator does not assume
  EXPECT_LT(sum / kDraws, 7.5);
}

TEST(LandmarkSighting, SigmasHaveLowerBounds) {
  Random random(12);
  ObservationOptions options;
  options.min_sigma_px = 0.3;
  options.min_range_fraction = 0.01;
  const double min_turn = RadiansFromDegrees(1);
  const auto sighting = MakeLandmarkSighting(RandomObjectPose(random, 4000), options,
                                             {.min_rotation_sigma_deg = 1, .reference_points = 0});
  ASSERT_TRUE(sighting);
  const Matrix6 covariance = sighting->information.inverse();
  for (int i = 0; i < 3; ++i) EXPECT_GE(covariance(i, i), min_turn * min_turn);
  EXPECT_GE(std::sqrt(covariance(5, 5)), 0.0099 * kRangeM);
  EXPECT_NEAR(std::sqrt(covariance(3, 3)), std::hypot(0.3 / kNarrowFocalPx * kRangeM, 0.01 * 6), 0.05);
}

// Few points at one end of the object, and a rotation error: the errors are consistent with the covariance.
TEST(LandmarkSighting, FewPointsAllowRotationAboutThem) {
  Random random(13);
  ObjectPose object_pose = RandomObjectPose(random, 10);
  const Vector3d end(2.5, 0, 0);
  for (PointObservation& point : object_pose.points) point.point += end;
  const ObservationOptions observation{.view_sigma_deg = 6};
  const auto sighting = MakeLandmarkSighting(object_pose, observation, {});
  ASSERT_TRUE(sighting);
  const Eigen::Matrix3d turn = Eigen::Matrix3d(RotationFromVector(Vector3d(0, RadiansFromDegrees(12), 0)));
  const Vector3d middle = object_pose.camera_from_object->rotation * (end + Vector3d(0.1, 0, 0));
  Vector6 error;
  error << VectorFromRotation(Eigen::Quaterniond(turn)), middle - turn * middle;
  const auto sigmas = [&](const LandmarkSighting& of) { return std::sqrt(error.dot(of.information * error)); };
  EXPECT_LT(sigmas(*sighting), 1.5);
  EXPECT_GT(
      sigmas(*MakeLandmarkSighting(object_pose, observation, {.min_rotation_sigma_deg = 1, .reference_points = 0})),
      1.8);
}

TEST(LandmarkSighting, PhotoModelGivesPositionWithoutRotation) {
  const ObjectPose object_pose{
      .direction = Vector3d(0, 0.6, 0.8), .sigma_rad = 0.01, .range_m = 50, .sigma_range_m = 15};
  const auto sighting = MakeLandmarkSighting(object_pose, {}, {});
  ASSERT_TRUE(sighting);
  EXPECT_TRUE(sighting->camera_from_landmark.translation.isApprox(Vector3d(0, 30, 40), 1e-12));
  EXPECT_EQ((sighting->information.topLeftCorner<3, 6>().norm()), 0);
  const Eigen::Matrix3d information = sighting->information.bottomRightCorner<3, 3>();
  EXPECT_NEAR(object_pose.direction.dot(information * object_pose.direction), 1 / (15.0 * 15), 1e-9);
  EXPECT_NEAR(information(0, 0), 1 / (0.5 * 0.5), 1e-9);
}

TEST(LandmarkSighting, MissingRangeGivesNone) {
  EXPECT_FALSE(MakeLandmarkSighting({.direction = Vector3d::UnitZ(), .sigma_rad = 0.01}, {}, {}));
}

}  // namespace
}  // namespace victorious
