#include "victorious/object/model/view_contours.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace victorious {
namespace {

constexpr double kFocal_px = 1000;
constexpr double kDistance_m = 5;

// A roof: two planes that meet in a ridge at x = 0, 4 m from the camera, with slopes of 45 degrees; 1 m wide, 1.2 m
// long.
PosedDepthMap MakeRoof() {
  PosedDepthMap roof;
  roof.camera.pinhole = {kFocal_px, kFocal_px, 200, 200, 400, 400};
  roof.camera.camera_from_world = {Eigen::Quaterniond::Identity(), {0, 0, kDistance_m}};
  roof.depth_m.create(400, 400, CV_32F);
  for (int row = 0; row < 400; ++row) {
    for (int column = 0; column < 400; ++column) {
      const double slope = std::abs((column + 0.5 - 200) / kFocal_px);
      const double depth_m = 4 / (1 - slope);  // depth = 4 + |x|, x = slope depth
      const double y_m = (row + 0.5 - 200) / kFocal_px * depth_m;
      const bool is_roof = slope * depth_m < 0.5 && std::abs(y_m) < 0.6;
      roof.depth_m.at<float>(row, column) =
          is_roof ? static_cast<float>(depth_m) : std::numeric_limits<float>::quiet_NaN();
    }
  }
  return roof;
}

TEST(ViewContours, AreRidgeAndOutlineOfARoof) {
  const std::vector<ContourPoint> contours = ReadContours(MakeRoof(), Eigen::Vector3d::Zero(), 1.6);
  int ridge = 0;
  int sides = 0;
  int ends = 0;
  for (const ContourPoint& point : contours) {
    const Eigen::Vector3d tangent = (point.beside_m - point.position_m).normalized();
    const Eigen::Vector2d from_axes = point.position_m.head<2>().cwiseAbs();
    const bool is_near_corner = from_axes.y() > 0.5 && (from_axes.x() > 0.4 || from_axes.x() < 0.1);
    if (is_near_corner) continue;  // lines of two edges
    if (std::abs(point.position_m.x()) < 0.005) {
      EXPECT_NEAR(point.position_m.z(), -1, 0.01);
      EXPECT_GT(std::abs(tangent.y()), 0.99);
      ++ridge;
    } else if (std::abs(std::abs(point.position_m.x()) - 0.5) < 0.01) {
      EXPECT_GT(std::abs(tangent.y()), 0.95);
      ++sides;
    } else {
      EXPECT_NEAR(std::abs(point.position_m.y()), 0.6, 0.02);
      EXPECT_NEAR(std::abs(tangent.z() / tangent.x()), 1, 0.15);  // along the slope
      ++ends;
    }
  }
  EXPECT_GT(ridge, 20);
  EXPECT_GT(sides, 40);
  EXPECT_GT(ends, 20);
}

TEST(ViewContours, FlatSurfaceHasNone) {
  PosedDepthMap flat = MakeRoof();
  for (int row = 0; row < 400; ++row) {
    for (int column = 0; column < 400; ++column)
      flat.depth_m.at<float>(row, column) = static_cast<float>(4 + 0.001 * row);
  }
  for (const ContourPoint& point : ReadContours(flat, Eigen::Vector3d::Zero(), 1.6)) {  // those of the image's border
    EXPECT_GT(std::max(std::abs(point.position_m.x()), std::abs(point.position_m.y())), 0.75);
  }
}

}  // namespace
}  // namespace victorious
