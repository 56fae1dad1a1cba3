// A Ground with heights given by a function.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "victorious/geometry/ground.h"

namespace victorious::testing {

/// Heights above the ellipsoid as a function of metres east and north of a point; NaN: unknown.
class SyntheticGround final : public Ground {
 public:
  SyntheticGround(const GeodeticPoint& origin, std::function<double(double east_m, double north_m)> height)
      : plane_({origin.latitude_rad, origin.longitude_rad, 0}), height_(std::move(height)) {}

  [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& point) const override {
    const Eigen::Vector3d at = plane_.EnuFromGeodetic({point.latitude_rad, point.longitude_rad, 0});
    const double height_m = height_(at.x(), at.y());
    return std::isnan(height_m) ? std::nullopt : std::optional(height_m);
  }
  [[nodiscard]] double Spacing() const override { return 2; }
  [[nodiscard]] double MaxSlope() const override { return 4; }

 private:
  TangentPlane plane_;
  std::function<double(double, double)> height_;
};

}  // namespace victorious::testing
