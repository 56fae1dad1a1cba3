#include "victorious/geometry/camera.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr PinholeCamera kCamera{.fx = 500, .fy = 510, .cx = 320, .cy = 240, .width = 640, .height = 480};

TEST(PinholeCamera, ProjectsRightAndDown) {
  EXPECT_EQ(kCamera.Project({0, 0, 2}), Eigen::Vector2d(320, 240));
  EXPECT_EQ(kCamera.Project({1, 2, 10}), Eigen::Vector2d(370, 342));
}

TEST(PinholeCamera, PointsBehindTheCameraAreNotProjected) {
  EXPECT_FALSE(kCamera.Project({0, 0, -1}));
  EXPECT_FALSE(kCamera.Project({0, 0, 0}));
}

TEST(PinholeCamera, RayInvertsProject) {
  const Eigen::Vector3d point(1.5, -0.7, 6);
  EXPECT_LT((kCamera.Unproject(*kCamera.Project(point)) * point.z() - point).norm(), 1e-12);
}

TEST(CentredPinhole, ImageEdgeIsHalfTheFieldOfView) {
  const PinholeCamera camera = CentredPinhole(kPi / 2, 640, 480);
  EXPECT_NEAR(camera.Project({1, 0, 1})->x(), 640, 1e-9);
  EXPECT_NEAR(camera.Project({0, 0, 1})->y(), 240, 1e-9);
  EXPECT_EQ(camera.fx, camera.fy);
}

}  // namespace
}  // namespace victorious
