#include "victorious/object/render/relight.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>

#include "victorious/input/image/srgb.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
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

// Grey levels of linear values, rounded to the nearest, by a table instead of a power.
class GreyFromLinear {
 public:
  GreyFromLinear() {
    for (std::size_t level = 0; level < kLevels; ++level) {
      thresholds_[level] = LinearFromSrgb((static_cast<double>(level) + 0.5) / (kLevels - 1));
    }
    thresholds_.back() = std::numeric_limits<double>::infinity();
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      const double from = static_cast<double>(cell) / kCells;
      levels_[cell] = static_cast<std::uint8_t>(std::ranges::upper_bound(thresholds_, from) - thresholds_.begin());
    }
  }

  /// @param linear  at least 0; 1 and more is white
  std::uint8_t operator()(double linear) const {
    std::uint8_t level = levels_[static_cast<std::size_t>(std::min(linear * kCells, kCells - 1.0))];
    while (linear > thresholds_[level]) ++level;
    return level;
  }

 private:
  static constexpr std::size_t kLevels = 256;
  static constexpr std::size_t kCells = 4096;

  std::array<double, kLevels> thresholds_;   // the largest linear value of each level
  std::array<std::uint8_t, kCells> levels_;  // the level of the smallest value of each cell of [0, 1]
};

// The 3D points of a depth map and their normals, in the frame of its camera.
class SurfaceGeometry {
 public:
  explicit SurfaceGeometry(const PosedDepthMap& depth_map) : depth_m_(depth_map.depth_m) {
    const PinholeCamera& pinhole = depth_map.camera.pinhole;
    for (int column = 0; column < depth_m_.cols; ++column) x_.push_back(pinhole.Unproject({column + 0.5, 0}).x());
    for (int row = 0; row < depth_m_.rows; ++row) y_.push_back(pinhole.Unproject({0, row + 0.5}).y());
  }

  [[nodiscard]] Vector3d PointAt(int row, int column) const {
    const double depth_m = depth_m_.ptr<float>(row)[column];
    return {depth_m * x_[static_cast<std::size_t>(column)], depth_m * y_[static_cast<std::size_t>(row)], depth_m};
  }

  // Unit normal, oriented towards the camera.
  [[nodiscard]] Vector3d NormalAt(int row, int column) const {
    const Vector3d normal = Difference(row, column, 1, 0).cross(Difference(row, column, 0, 1));
    const double length = normal.norm();
    if (!(length > 0)) return -Vector3d::UnitZ();
    return normal / (normal.z() > 0 ? -length : length);
  }

 private:
  // One-sided finite difference of the 3D points along an image axis. Uses the neighbour with the smaller depth
  // difference, so that a depth discontinuity is not taken for a slope.
  [[nodiscard]] Vector3d Difference(int row, int column, int down, int right) const {
    const float here = DepthAt(row, column);
    const float next = std::abs(DepthAt(row + down, column + right) - here);
    const float last = std::abs(DepthAt(row - down, column - right) - here);
    if (std::isnan(next) && std::isnan(last)) return Vector3d::Zero();
    if (std::isnan(last) || next <= last) return PointAt(row + down, column + right) - PointAt(row, column);
    return PointAt(row, column) - PointAt(row - down, column - right);
  }

  [[nodiscard]] float DepthAt(int row, int column) const {
    if (row < 0 || column < 0 || row >= depth_m_.rows || column >= depth_m_.cols) return std::nanf("");
    return depth_m_.ptr<float>(row)[column];
  }

  const cv::Mat& depth_m_;
  std::vector<double> x_;  // of the points at depth 1, by column
  std::vector<double> y_;  // by row
};

double Irradiance(const Light& light, double cos_up, double sun) {
  return light.ground + (light.sky - light.ground) * 0.5 * (1 + cos_up) + light.sun * sun;
}

// The least float that is not below a value: the same floats are less than either.
float RoundUp(double value) {
  const auto nearest = static_cast<float>(value);
  if (!(nearest < value)) return nearest;
  // std::nextafter is a call. The bits of positive floats are in the order of their values.
  return nearest > 0 ? std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) + 1)
                     : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

// The shadow map: the depth map from near the direction of the sun.
class SunShadow {
 public:
  /// @param from_sun          outlives this
  /// @param world_from_camera  of the points that are tested
  SunShadow(const PosedDepthMap& from_sun, const Rigid3& world_from_camera)
      : depth_m_(from_sun.depth_m),
        pinhole_(from_sun.camera.pinhole),
        rotation_((from_sun.camera.camera_from_world.rotation * world_from_camera.rotation).toRotationMatrix()),
        translation_(from_sun.camera.camera_from_world.Apply(world_from_camera.translation)) {}

  // Visible fraction of the sun at a point: the fraction of 3 x 3 texels of the shadow map about it that do not occlude
  // it. Point and normal in the frame of the camera.
  [[nodiscard]] double SunVisibleFraction(const Vector3d& point_in_camera, const Vector3d& normal) const {
    const Vector3d unbiased = rotation_ * point_in_camera + translation_;
    const double texel_m = unbiased.z() / pinhole_.fx;
    const Vector3d point = unbiased + kNormalOffset_texels * texel_m * (rotation_ * normal);
    const auto pixel = pinhole_.Project(point);
    if (!pixel) return 1;
    const int column = static_cast<int>(std::floor(pixel->x()));
    const int row = static_cast<int>(std::floor(pixel->y()));
    const float limit = RoundUp(point.z() - kDepthBias_texels * texel_m);
    int hidden = 0;
    if (column >= kFilterReach && row >= kFilterReach && column < depth_m_.cols - kFilterReach &&
        row < depth_m_.rows - kFilterReach) {
      for (int y = -kFilterReach; y <= kFilterReach; ++y) {  // unrolled, without branches
        const float* const depths_m = depth_m_.ptr<float>(row + y) + column;
        for (int x = -kFilterReach; x <= kFilterReach; ++x) hidden += static_cast<int>(depths_m[x] < limit);
      }
    } else {
      const int first = std::max(0, column - kFilterReach);
      const int last = std::min(depth_m_.cols - 1, column + kFilterReach);
      for (int y = std::max(0, row - kFilterReach); y <= std::min(depth_m_.rows - 1, row + kFilterReach); ++y) {
        const float* const depths_m = depth_m_.ptr<float>(y);
        for (int x = first; x <= last; ++x) hidden += static_cast<int>(depths_m[x] < limit);  // false for NaN
      }
    }
    constexpr double kSide = 2 * kFilterReach + 1;
    return 1 - hidden / (kSide * kSide);
  }

 private:
  const cv::Mat& depth_m_;
  const PinholeCamera& pinhole_;
  Matrix3d rotation_;  // sun camera from camera
  Vector3d translation_;
};

}  // namespace

Light ClearDayLight(const ViewDirection& sun) {
  return {.sky = kClearSky, .ground = kClearGround, .sun = kClearSun, .to_sun_in_world = DirectionToCamera(sun)};
}

cv::Mat Relight(const cv::Mat& grey, const PosedDepthMap& depth_map, const Light& before, const Light& after,
                const PosedDepthMap& from_sun) {
  static const GreyFromLinear kGreyFromLinear;
  const std::array<float, 256>& linear_from_grey = LinearFromGreyTable();
  const Rigid3 world_from_camera = depth_map.camera.camera_from_world.Inverse();
  const Rigid3& camera_from_world = depth_map.camera.camera_from_world;
  // In the frame of the camera.
  const Vector3d up = camera_from_world.rotation * Vector3d::UnitZ();
  const Vector3d to_sun_before = camera_from_world.rotation * before.to_sun_in_world.normalized();
  const Vector3d to_sun_after = camera_from_world.rotation * after.to_sun_in_world.normalized();
  const SurfaceGeometry geometry(depth_map);
  const SunShadow shadows(from_sun, world_from_camera);
  cv::Mat relit = grey.clone();
  for (int row = 0; row < grey.rows; ++row) {
    const float* const depths_m = depth_map.depth_m.ptr<float>(row);
    std::uint8_t* const greys = relit.ptr<std::uint8_t>(row);
    for (int column = 0; column < grey.cols; ++column) {
      if (std::isnan(depths_m[column])) continue;
      const Vector3d normal = geometry.NormalAt(row, column);
      const double cos_up = normal.dot(up);
      const double sun_before = std::max(0.0, normal.dot(to_sun_before));
      double sun_after = std::max(0.0, normal.dot(to_sun_after));
      if (sun_after > 0) sun_after *= shadows.SunVisibleFraction(geometry.PointAt(row, column), normal);
      greys[column] = kGreyFromLinear(linear_from_grey[greys[column]] * Irradiance(after, cos_up, sun_after) /
                                      std::max(kMinIrradiance, Irradiance(before, cos_up, sun_before)));
    }
  }
  return relit;
}

std::vector<SurfacePoint> ReadSurface(const cv::Mat& grey, const PosedDepthMap& depth_map, const Light& light) {
  const std::array<float, 256>& linear_from_grey = LinearFromGreyTable();
  const Rigid3 world_from_camera = depth_map.camera.camera_from_world.Inverse();
  const Vector3d to_sun = light.to_sun_in_world.normalized();
  const SurfaceGeometry geometry(depth_map);
  std::vector<SurfacePoint> points;
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      if (std::isnan(depth_map.depth_m.at<float>(row, column))) continue;
      const Vector3d normal = world_from_camera.rotation * geometry.NormalAt(row, column);
      const double irradiance = Irradiance(light, normal.z(), std::max(0.0, normal.dot(to_sun)));
      const double albedo = linear_from_grey[grey.at<std::uint8_t>(row, column)] / std::max(kMinIrradiance, irradiance);
      points.push_back({.position_m = world_from_camera.Apply(geometry.PointAt(row, column)).cast<float>(),
                        .normal = normal.cast<float>(),
                        .albedo = static_cast<float>(std::min(1.0, albedo))});
    }
  }
  return points;
}

}  // namespace victorious
