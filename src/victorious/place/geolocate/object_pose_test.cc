#include "victorious/place/geolocate/object_pose.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kFocalPx = 2000;

Rigid3 MakePose(double tilt_deg, double turn_deg, const Eigen::Vector3d& place) {
  return {Eigen::AngleAxisd(RadiansFromDegrees(turn_deg), Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(RadiansFromDegrees(tilt_deg), Eigen::Vector3d::UnitX()),
          place};
}

std::vector<PointObservation> MakeObservations(const Rigid3& camera_from_object, int count, double noise_px,
                                               std::uint64_t seed) {
  Random random(seed);
  std::vector<PointObservation> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d point(4 * random.Uniform() - 2, 2 * random.Uniform() - 1, 1.5 * random.Uniform() - 0.75);
    const Eigen::Vector3d p = camera_from_object.Apply(point);
    const Eigen::Vector2d noise(random.Normal(), random.Normal());
    points.push_back({point, Eigen::Vector2d(p.x(), p.y()) / p.z() + noise_px / kFocalPx * noise});
  }
  return points;
}

ObjectPoseFitOptions Options() { return {.sigma = 1 / kFocalPx, .sigma_view_rad = RadiansFromDegrees(6)}; }

TEST(ObjectPoseFit, RecoversExactPose) {
  const Rigid3 truth = MakePose(40, 100, {3, -5, 120});
  const auto found =
      FitObjectPose(MakeObservations(truth, 12, 0, 1), MakePose(44, 97, Eigen::Vector3d::Zero()).rotation, Options());
  ASSERT_TRUE(found);
  EXPECT_LT((found->camera_from_object.translation - truth.translation).norm(), 0.3);
  EXPECT_LT(found->camera_from_object.rotation.angularDistance(truth.rotation), RadiansFromDegrees(1));
}

TEST(ObjectPoseFit, CovarianceIsConsistent) {
  const Rigid3 truth = MakePose(35, -60, {-2, 4, 130});
  int near = 0;
  constexpr int kDraws = 200;
  for (int i = 0; i < kDraws; ++i) {
    const auto found = FitObjectPose(MakeObservations(truth, 15, 1, 100 + i), truth.rotation, Options());
    ASSERT_TRUE(found);
    const double off = std::abs(found->camera_from_object.translation.norm() - truth.translation.norm());
    near += off < found->sigma_range_m ? 1 : 0;
    EXPECT_LT(found->sigma_range_m, 6);
    EXPECT_GT(found->sigma_angle_rad, 0.1 / kFocalPx);
    EXPECT_LT(found->sigma_angle_rad, 1.5 / kFocalPx);
  }
  EXPECT_GT(near, 0.6 * kDraws);  // one sigma contains 68 %
}

TEST(ObjectPoseFit, IsRobustToAnOutlier) {
  const Rigid3 truth = MakePose(40, 10, {0, 0, 100});
  std::vector<PointObservation> points = MakeObservations(truth, 12, 0.5, 3);
  points[4].seen += Eigen::Vector2d(25, -10) / kFocalPx;
  const auto found = FitObjectPose(points, truth.rotation, Options());
  ASSERT_TRUE(found);
  EXPECT_LT((found->camera_from_object.translation - truth.translation).head<2>().norm(), 0.05);
  EXPECT_NEAR(found->camera_from_object.translation.z(), 100, 3);
}

TEST(ObjectPoseFit, TooFewPointsGiveNoPose) {
  const Rigid3 truth = MakePose(40, 10, {0, 0, 100});
  EXPECT_FALSE(FitObjectPose(MakeObservations(truth, 2, 0, 3), truth.rotation, Options()));
}

}  // namespace
}  // namespace victorious
