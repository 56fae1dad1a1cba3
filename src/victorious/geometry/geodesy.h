// Places on Earth: geodetic coordinates on the WGS 84 ellipsoid, and the tangent plane at a point, whose axes are east,
// north and up (ENU) there.
//
// The planes of two points are turned against each other: by the convergence of the meridians about the vertical, and
// by the Earth's curvature. Over the hundred metres of a flight that is a thousandth of a degree.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace victorious {

struct GeodeticPoint {
  double latitude_rad = 0;   ///< [-pi/2, pi/2]
  double longitude_rad = 0;  ///< eastwards
  double altitude_m = 0;     ///< above the ellipsoid

  bool operator==(const GeodeticPoint&) const = default;
};

/// East, north and up at `origin`, metres; straight, so that a far point of the ground lies below it.
class TangentPlane {
 public:
  explicit TangentPlane(const GeodeticPoint& origin) : origin_(origin) {}

  [[nodiscard]] const GeodeticPoint& origin() const { return origin_; }

  [[nodiscard]] Eigen::Vector3d EnuFromGeodetic(const GeodeticPoint& point) const;
  [[nodiscard]] GeodeticPoint GeodeticFromEnu(const Eigen::Vector3d& point_in_enu) const;

  /// Turns a direction from this plane's axes to those of the plane at `point_in_enu`.
  [[nodiscard]] Eigen::Quaterniond LocalEnuFromEnu(const Eigen::Vector3d& point_in_enu) const;

 private:
  GeodeticPoint origin_;
};

}  // namespace victorious
