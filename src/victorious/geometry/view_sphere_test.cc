#include "victorious/geometry/view_sphere.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

double AngleBetween(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

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
