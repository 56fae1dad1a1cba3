#include "victorious/render/relight.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core.hpp>

#include "victorious/image/srgb.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// Irradiances of a clear day (Light): the sun contributes about two thirds of that of a surface that faces it,
// 0.9 of 0.9 + 0.4.
constexpr double kClearSky = 0.4;
constexpr double kClearGround = 0.25;
constexpr double kClearSun = 0.9;

// Shadow mapping, in texels of the shadow map. The point is moved along its normal (normal offset bias) by the reach of
// the 3 x 3 texels that are read, and an occluder must be nearer to the sun by a texel: else a surface would shadow
// itself.
constexpr double kNormalOffset_texels = 1.5;
constexpr double kDepthBias_texels = 1;
constexpr int kFilterReach = 1;  // texels on either side

constexpr double kMinIrradiance = 1e-3;  // a divisor; below it the rendering is black and has no albedo

const std::array<float, 256>& LinearFromGreyTable() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(LinearFromSrgb(static_cast<double>(i) / 255));
    return values;
  }();
  return table;
}

float DepthAt(const cv::Mat& depth_m, int row, int column) {
  if (row < 0 || column < 0 || row >= depth_m.rows || column >= depth_m.cols) return std::nanf("");
  return depth_m.at<float>(row, column);
}

Vector3d PointAt(const PosedDepthMap& depth_map, int row, int column) {
  return DepthAt(depth_map.depth_m, row, column) * depth_map.camera.pinhole.Unproject({column + 0.5, row + 0.5});
}

// One-sided finite difference of the 3D points along an image axis. Uses the neighbour with the smaller depth
// difference, so that a depth discontinuity is not taken for a slope.
Vector3d Difference(const PosedDepthMap& depth_map, int row, int column, int down, int right) {
  const float here = DepthAt(depth_map.depth_m, row, column);
  const float next = std::abs(DepthAt(depth_map.depth_m, row + down, column + right) - here);
  const float last = std::abs(DepthAt(depth_map.depth_m, row - down, column - right) - here);
  if (std::isnan(next) && std::isnan(last)) return Vector3d::Zero();
  if (std::isnan(last) || next <= last)
    return PointAt(depth_map, row + down, column + right) - PointAt(depth_map, row, column);
  return PointAt(depth_map, row, column) - PointAt(depth_map, row - down, column - right);
}

// Unit normal in the camera frame, oriented towards the camera.
Vector3d NormalAt(const PosedDepthMap& depth_map, int row, int column) {
  const Vector3d normal = Difference(depth_map, row, column, 1, 0).cross(Difference(depth_map, row, column, 0, 1));
  const double length = normal.norm();
  if (!(length > 0)) return -Vector3d::UnitZ();
  return normal / (normal.z() > 0 ? -length : length);
}

// Visible fraction of the sun at a point: the fraction of 3 x 3 texels of the shadow map about it that do not occlude
// it.
double SunVisibleFraction(const Vector3d& point_in_world, const Vector3d& normal, const PosedDepthMap& from_sun) {
  const PinholeCamera& pinhole = from_sun.camera.pinhole;
  const Vector3d unbiased = from_sun.camera.camera_from_world.Apply(point_in_world);
  const double texel_m = unbiased.z() / pinhole.fx;
  const Vector3d point =
      unbiased + kNormalOffset_texels * texel_m * (from_sun.camera.camera_from_world.rotation * normal);
  const auto pixel = pinhole.Project(point);
  if (!pixel) return 1;
  const int column = static_cast<int>(std::floor(pixel->x()));
  const int row = static_cast<int>(std::floor(pixel->y()));
  int hidden = 0;
  for (int down = -kFilterReach; down <= kFilterReach; ++down) {
    for (int right = -kFilterReach; right <= kFilterReach; ++right) {
      const double limit = point.z() - kDepthBias_texels * texel_m;
      hidden += DepthAt(from_sun.depth_m, row + down, column + right) < limit ? 1 : 0;
    }
  }
  constexpr double kSide = 2 * kFilterReach + 1;
  return 1 - hidden / (kSide * kSide);
}

}  // namespace

Light ClearDayLight(const ViewDirection& sun) {
  return {.sky = kClearSky, .ground = kClearGround, .sun = kClearSun, .to_sun_in_world = DirectionToCamera(sun)};
}

cv::Mat Relight(const cv::Mat& grey, const PosedDepthMap& depth_map, const Light& before, const Light& after,
                const PosedDepthMap& from_sun) {
  const Rigid3 world_from_camera = depth_map.camera.camera_from_world.Inverse();
  const Vector3d to_sun_before = before.to_sun_in_world.normalized();
  const Vector3d to_sun_after = after.to_sun_in_world.normalized();
  cv::Mat relit = grey.clone();
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      if (std::isnan(depth_map.depth_m.at<float>(row, column))) continue;
      const Vector3d normal = world_from_camera.rotation * NormalAt(depth_map, row, column);
      const auto irradiance = [&](const Light& light, double sun) {
        return light.ground + (light.sky - light.ground) * 0.5 * (1 + normal.z()) + light.sun * sun;
      };
      const double sun_before = std::max(0.0, normal.dot(to_sun_before));
      double sun_after = std::max(0.0, normal.dot(to_sun_after));
      if (sun_after > 0) {
        sun_after *= SunVisibleFraction(world_from_camera.Apply(PointAt(depth_map, row, column)), normal, from_sun);
      }
      const double linear = LinearFromGreyTable()[grey.at<std::uint8_t>(row, column)] * irradiance(after, sun_after) /
                            std::max(kMinIrradiance, irradiance(before, sun_before));
      relit.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(255 * SrgbFromLinear(linear));
    }
  }
  return relit;
}

}  // namespace victorious
