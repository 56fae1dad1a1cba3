#include "victorious/geometry/ground.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "testing/drawn_ground.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;
using testing::SyntheticGround;

const TangentPlane kPlane({0.7, 0.2, 0});

std::expected<GroundPatch, GroundMiss> Intersect(const Ground& ground, const Vector3d& from, const Vector3d& towards,
                                                 double slack_m = 0) {
  return IntersectGround(ground, kPlane, from, (towards - from).normalized(), slack_m);
}

TEST(Ground, RayIntersectsEllipsoidalGround) {
  const FlatGround ground(10);
  for (const double far_m : {1.0, 300.0, 5000.0}) {
    const auto met = Intersect(ground, {0, 0, 110}, {far_m, 0, 10});
    ASSERT_TRUE(met) << far_m;
    const GeodeticPoint point = kPlane.GeodeticFromEnu(met->point);
    EXPECT_NEAR(point.altitude_m, 10, 1e-3);
    EXPECT_NEAR(met->point.x(), far_m, far_m * 0.05);
    EXPECT_NEAR((kPlane.LocalEnuFromEnu(met->point) * met->normal).z(), 1, 1e-9);
  }
  EXPECT_EQ(Intersect(ground, {0, 0, 110}, {100, 0, 110}).error(), GroundMiss::kAbove);
  EXPECT_EQ(Intersect(ground, {0, 0, 110}, {100, 0, 200}).error(), GroundMiss::kAbove);
  EXPECT_EQ(Intersect(ground, {0, 0, 5}, {100, 0, -50}).error(), GroundMiss::kBelow);
  EXPECT_EQ(Intersect(ground, {0, 0, 9}, {100, 0, -50}, 3).error(), GroundMiss::kBelow)
      << "the ray never leaves the ground";
}

TEST(Ground, RayIntersectsTheNearerHill) {
  const SyntheticGround ground(kPlane.origin(), [](double east, double) {
    return 40 * std::exp(-std::pow((east - 300) / 40, 2)) + 60 * std::exp(-std::pow((east - 600) / 40, 2));
  });
  const auto near = Intersect(ground, {0, 0, 60}, {300, 0, 35});
  ASSERT_TRUE(near);
  EXPECT_LT(near->point.x(), 300);
  EXPECT_LT(near->normal.x(), -0.2) << "it faces the camera";
  const auto far = Intersect(ground, {0, 0, 60}, {300, 0, 41});  // 1 m above the first hill's top
  ASSERT_TRUE(far);
  EXPECT_GT(far->point.x(), 500);
  const auto behind = Intersect(ground, {450, 0, 30}, {500, 0, 0});
  ASSERT_TRUE(behind);
  EXPECT_NEAR(behind->point.x(), 500, 5);
}

// For random grounds and rays: the intersection is on the ground and on the ray, and no earlier point of the ray is
// below the ground.
TEST(Ground, IntersectionIsTheFirst) {
  Random random(7);
  int met_count = 0;
  for (int i = 0; i < 300; ++i) {
    const double length = random.Uniform(20, 200);
    const double height = random.Uniform(0, 0.3 * length);
    const double turn = random.Uniform(0, 6);
    const SyntheticGround ground(kPlane.origin(), [=](double east, double north) {
      return height * std::sin(east / length + turn) * std::cos(north / length);
    });
    const Vector3d from(0, 0, height + random.Uniform(2, 200));
    const double azimuth = random.Uniform(0, 2 * kPi);
    const double elevation = random.Uniform(-kPi / 2, 0.05);
    const Vector3d along(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
                         std::sin(elevation));
    const auto met = IntersectGround(ground, kPlane, from, along, 0);
    if (!met) continue;
    ++met_count;
    const double distance_m = (met->point - from).dot(along);
    EXPECT_LT((from + distance_m * along - met->point).norm(), 0.01) << i;
    EXPECT_LT(met->normal.dot(along), 0) << i;
    for (int k = 0; k < 200; ++k) {
      const GeodeticPoint before = kPlane.GeodeticFromEnu(from + distance_m * k / 200 * along);
      EXPECT_GT(before.altitude_m, *ground.HeightAt(before) - 0.5) << i << ", " << k;
    }
  }
  EXPECT_GT(met_count, 200);
}

TEST(Ground, UnknownGroundIsSkippedIfTheRayExitsAboveIt) {
  const auto ground_with_hole = [](double first_m, double last_m) {
    return SyntheticGround(kPlane.origin(),
                           [=](double east, double) { return east > first_m && east < last_m ? std::nan("") : 0.0; });
  };
  EXPECT_TRUE(Intersect(ground_with_hole(100, 200), {0, 0, 100}, {300, 0, 0}));
  EXPECT_EQ(Intersect(ground_with_hole(250, 350), {0, 0, 100}, {300, 0, 0}).error(), GroundMiss::kUnknown);
  EXPECT_EQ(Intersect(ground_with_hole(250, 1e9), {0, 0, 100}, {300, 0, 0}).error(), GroundMiss::kUnknown);
  EXPECT_TRUE(Intersect(ground_with_hole(-1e9, 200), {0, 0, 100}, {300, 0, 0}))
      << "the camera outside the known ground";
}

TEST(Ground, CameraSlightlyBelowGroundUsesExitPoint) {
  const SyntheticGround slope(
      kPlane.origin(), [](double east, double) { return east < 50 ? 10 - 0.2 * east : -20 + 0.2 * (east - 50); });
  EXPECT_EQ(Intersect(slope, {0, 0, 9}, {100, 0, -6}).error(), GroundMiss::kBelow);
  const auto met = Intersect(slope, {0, 0, 9}, {100, 0, -6}, 2);  // it emerges after 20 m
  ASSERT_TRUE(met);
  EXPECT_GT(met->point.x(), 60);
}

TEST(Ground, RaisedGroundHasTheGivenOffset) {
  const auto ground = std::make_shared<const FlatGround>(5);
  EXPECT_EQ(*RaisedGround(ground, 1.5).HeightAt({}), 6.5);
  EXPECT_FALSE(
      RaisedGround(
          std::make_shared<const SyntheticGround>(kPlane.origin(), [](double, double) { return std::nan(""); }), 1)
          .HeightAt({0.7, 0.2, 0}));
}

}  // namespace
}  // namespace victorious
