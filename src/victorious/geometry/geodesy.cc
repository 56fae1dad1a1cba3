#include "victorious/geometry/geodesy.h"

#include <vector>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

GeographicLib::LocalCartesian PlaneAt(const GeodeticPoint& origin) {
  return {DegreesFromRadians(origin.latitude_rad), DegreesFromRadians(origin.longitude_rad), origin.altitude_m};
}

}  // namespace

Eigen::Vector3d EarthCenteredFromGeodetic(const GeodeticPoint& point) {
  Eigen::Vector3d at;
  GeographicLib::Geocentric::WGS84().Forward(DegreesFromRadians(point.latitude_rad),
                                             DegreesFromRadians(point.longitude_rad), point.altitude_m, at.x(), at.y(),
                                             at.z());
  return at;
}

Eigen::Vector3d TangentPlane::EnuFromGeodetic(const GeodeticPoint& point) const {
  Eigen::Vector3d enu;
  PlaneAt(origin_).Forward(DegreesFromRadians(point.latitude_rad), DegreesFromRadians(point.longitude_rad),
                           point.altitude_m, enu.x(), enu.y(), enu.z());
  return enu;
}

GeodeticPoint TangentPlane::GeodeticFromEnu(const Eigen::Vector3d& point_in_enu) const {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;
  PlaneAt(origin_).Reverse(point_in_enu.x(), point_in_enu.y(), point_in_enu.z(), latitude_deg, longitude_deg,
                           altitude_m);
  return {RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg), altitude_m};
}

Eigen::Quaterniond TangentPlane::LocalEnuFromEnu(const Eigen::Vector3d& point_in_enu) const {
  double unused = 0;
  std::vector<double> enu_from_local(9);  // row-major
  PlaneAt(origin_).Reverse(point_in_enu.x(), point_in_enu.y(), point_in_enu.z(), unused, unused, unused,
                           enu_from_local);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(enu_from_local.data());
  return Eigen::Quaterniond(Eigen::Matrix3d(turn.transpose()));
}

}  // namespace victorious
