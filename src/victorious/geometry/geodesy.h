// Geodetic coordinates on the WGS 84 ellipsoid, and the tangent plane at a point with its axes east, north and up
// (ENU). Computed by GeographicLib.
//
// The tangent planes of two points are rotated against each other: by the meridian convergence about the vertical, and
// by the Earth's curvature. Over the hundred metres of a flight this is a thousandth of a degree.
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

/// Geocentric Cartesian coordinates, m: z to the north pole, x to latitude 0, longitude 0.
[[nodiscard]] Eigen::Vector3d EarthCenteredFromGeodetic(const GeodeticPoint& point);

/// Cartesian coordinates east, north, up at `origin`, metres. The plane is flat: distant ground lies below it.
class TangentPlane {
 public:
  explicit TangentPlane(const GeodeticPoint& origin);

  [[nodiscard]] const GeodeticPoint& origin() const { return origin_; }

  [[nodiscard]] Eigen::Vector3d EnuFromGeodetic(const GeodeticPoint& point) const;
  [[nodiscard]] GeodeticPoint GeodeticFromEnu(const Eigen::Vector3d& point_in_enu) const;

  /// The rotation from this plane's axes to those of the tangent plane at `point_in_enu`.
  [[nodiscard]] Eigen::Quaterniond LocalEnuFromEnu(const Eigen::Vector3d& point_in_enu) const;

 private:
  GeodeticPoint origin_;
  Eigen::Vector3d origin_in_earth_m_;  ///< geocentric
  Eigen::Matrix3d enu_from_earth_;
};

}  // namespace victorious
