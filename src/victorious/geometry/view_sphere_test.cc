#include "victorious/geometry/view_sphere.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

TEST(ViewSphere, HasTheViewsOfTheThesis) {
  const auto sphere = MakeViewSphere({});
  ASSERT_TRUE(sphere);
  ASSERT_EQ(sphere->views.size(), 253);
  EXPECT_EQ(sphere->views[0].direction.off_nadir_rad, 0);
  EXPECT_DOUBLE_EQ(sphere->views[1].direction.off_nadir_rad, RadiansFromDegrees(10));
  EXPECT_DOUBLE_EQ(sphere->views.back().direction.off_nadir_rad, RadiansFromDegrees(70));
  EXPECT_DOUBLE_EQ(sphere->views.back().direction.azimuth_rad, RadiansFromDegrees(350));
  EXPECT_EQ(MakeViewSphere({.step_deg = 5})->views.size(), 1 + 14 * 72);
  EXPECT_EQ(MakeViewSphere({.max_off_nadir_deg = 0})->views.size(), 1);
}

TEST(ViewSphere, NeighboursAreMutualAdjacentAndComplete) {
  const auto sphere = MakeViewSphere({});
  ASSERT_TRUE(sphere);
  const auto& views = sphere->views;
  for (int i = 0; i < 253; ++i) {
    const auto& neighbours = views[static_cast<std::size_t>(i)].neighbours;
    EXPECT_TRUE(std::ranges::is_sorted(neighbours));
    EXPECT_EQ(std::set<int>(neighbours.begin(), neighbours.end()).size(), neighbours.size());
    EXPECT_EQ(neighbours.size(), i == 0 ? 36U : i <= 36 ? 6U : i >= 253 - 36 ? 5U : 8U) << i;
    for (const int j : neighbours) {
      EXPECT_NE(i, j);
      const auto& other = views[static_cast<std::size_t>(j)];
      EXPECT_TRUE(std::ranges::binary_search(other.neighbours, i));
      EXPECT_LT(AngleBetween(DirectionToCamera(views[static_cast<std::size_t>(i)].direction),
                             DirectionToCamera(other.direction)),
                RadiansFromDegrees(14.2));
    }
  }
}

// The numbers of views in the rings, from the pole on.
std::vector<int> CountInRings(const ViewSphere& sphere) {
  std::map<double, int> rings;
  for (const ViewSphere::View& view : sphere.views) ++rings[view.direction.off_nadir_rad];
  std::vector<int> counts;
  for (const auto& [off_nadir_rad, count] : rings) counts.push_back(count);
  return counts;
}

TEST(ViewSphere, OfEqualDensityHasAsManyViewsInARingAsItsCircumferenceNeeds) {
  const auto sphere = MakeViewSphere({.layout = ViewLayout::kEven});
  ASSERT_TRUE(sphere);
  EXPECT_EQ(CountInRings(*sphere), (std::vector<int>{1, 7, 13, 18, 24, 28, 32, 34}));
  EXPECT_EQ(sphere->views.size(), 157);
  EXPECT_EQ(sphere->views[1].direction.azimuth_rad, 0);
  EXPECT_DOUBLE_EQ(sphere->views[9].direction.azimuth_rad, 2 * kPi / 13);
  EXPECT_DOUBLE_EQ(sphere->views[9].direction.off_nadir_rad, RadiansFromDegrees(20));
  EXPECT_DOUBLE_EQ(sphere->views.back().direction.off_nadir_rad, RadiansFromDegrees(70));
  EXPECT_EQ(MakeViewSphere({.max_off_nadir_deg = 0, .layout = ViewLayout::kEven})->views.size(), 1);
  const auto whole = MakeViewSphere({.step_deg = 30, .max_off_nadir_deg = 180, .layout = ViewLayout::kEven});
  EXPECT_EQ(CountInRings(*whole), (std::vector<int>{1, 6, 11, 12, 11, 6}));
  EXPECT_TRUE(MakeViewSphere({.step_deg = 7, .layout = ViewLayout::kEven})) << "need not divide 360";
}

TEST(ViewSphere, OfEqualDensityHasNeighboursOnAllSides) {
  for (const double step_deg : {3.0, 7.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0, 45.0, 60.0, 90.0}) {
    SCOPED_TRACE(step_deg);
    const auto sphere = MakeViewSphere({.step_deg = step_deg, .max_off_nadir_deg = 180, .layout = ViewLayout::kEven});
    ASSERT_TRUE(sphere);
    const auto& views = sphere->views;
    const auto ring_of = [&](std::size_t i) {
      return static_cast<int>(std::lround(DegreesFromRadians(views[i].direction.off_nadir_rad) / step_deg));
    };
    const int last_ring = ring_of(views.size() - 1);
    for (std::size_t i = 0; i < views.size(); ++i) {
      std::map<int, int> rings;
      const auto& neighbours = views[i].neighbours;
      EXPECT_EQ(std::ranges::adjacent_find(neighbours, std::ranges::greater_equal{}), neighbours.end()) << i;
      for (const int neighbour : neighbours) {
        const auto j = static_cast<std::size_t>(neighbour);
        ASSERT_NE(i, j);
        EXPECT_TRUE(std::ranges::binary_search(views[j].neighbours, static_cast<int>(i))) << i << ", " << j;
        const double angle_rad =
            AngleBetween(DirectionToCamera(views[i].direction), DirectionToCamera(views[j].direction));
        EXPECT_LE(angle_rad, RadiansFromDegrees(1.5 * step_deg) + 1e-12) << i << ", " << j;
        ++rings[ring_of(j)];
      }
      if (i == 0) continue;  // the pole has the whole first ring
      const int ring = ring_of(i);
      EXPECT_EQ(rings[ring], 2) << i;
      EXPECT_GE(rings[ring - 1], 1) << i;
      EXPECT_GE(rings[ring + 1], ring == last_ring ? 0 : 1) << i;
      EXPECT_LE(neighbours.size(), 9U) << i;
    }
  }
}

TEST(ViewSphere, RefusesInvalidOptions) {
  EXPECT_FALSE(MakeViewSphere({.step_deg = 7}));
  EXPECT_FALSE(MakeViewSphere({.step_deg = 0}));
  EXPECT_FALSE(MakeViewSphere({.max_off_nadir_deg = 200}));
}

TEST(CameraForView, SphereFillsTheImage) {
  const Sphere sphere{{1, -2, 3}, 2.5};
  const ViewFraming framing{.distance_m = 12, .diameter_px = 200, .width_px = 320, .height_px = 240};
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    const ViewDirection direction{random.Uniform(0, 2 * kPi), random.Uniform(0, kPi / 2)};
    const auto camera = CameraForView(direction, sphere, framing);
    ASSERT_TRUE(camera);
    const Vector3d centre = camera->camera_from_world.Apply(sphere.centre);
    EXPECT_LT((centre - Vector3d(0, 0, 12)).norm(), 1e-9);
    EXPECT_LT((*camera->pinhole.Project(centre) - Eigen::Vector2d(160, 120)).norm(), 1e-9);
    const Vector3d eye = camera->camera_from_world.Inverse().Apply(Vector3d::Zero());
    EXPECT_LT(((eye - sphere.centre).normalized() - DirectionToCamera(direction)).norm(), 1e-9);
    // The ray through the outline is tangent to the sphere.
    const Vector3d ray = camera->pinhole.Unproject({160 + 100, 120}).normalized();
    EXPECT_NEAR(ray.cross(centre).norm(), sphere.radius, 1e-9);
    // The model's up axis points upwards in the image.
    const Vector3d up = camera->camera_from_world.rotation * Vector3d::UnitZ();
    EXPECT_NEAR(up.x(), 0, 1e-9);
    EXPECT_LT(up.y(), 0);
  }
}

TEST(CameraForView, FromAboveTheFrontPointsUp) {
  const auto camera = CameraForView({}, {{0, 0, 0}, 1}, {10, 100, 100, 100});
  ASSERT_TRUE(camera);
  EXPECT_LT((camera->camera_from_world.rotation * Vector3d::UnitX() - Vector3d(0, -1, 0)).norm(), 1e-9);
  EXPECT_LT((camera->camera_from_world.rotation * Vector3d::UnitY() - Vector3d(-1, 0, 0)).norm(), 1e-9);
}

TEST(CameraForView, RefusesInvalidArguments) {
  const Sphere sphere{{0, 0, 0}, 2};
  EXPECT_FALSE(CameraForView({}, sphere, {2, 100, 100, 100}));
  EXPECT_FALSE(CameraForView({}, sphere, {10, 0, 100, 100}));
  EXPECT_FALSE(CameraForView({}, sphere, {10, 100, 0, 100}));
  EXPECT_FALSE(CameraForView({}, {}, {10, 100, 100, 100}));
}

}  // namespace
}  // namespace victorious
