#include "victorious/geometry/geodesy.h"

#include <cmath>

#include <GeographicLib/Geocentric.hpp>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

GeodeticPoint GeodeticFromEarthCentered(const Vector3d& at) {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;
  GeographicLib::Geocentric::WGS84().Reverse(at.x(), at.y(), at.z(), latitude_deg, longitude_deg, altitude_m);
  return {RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg), altitude_m};
}

// The rows are the unit vectors east, north and up in geocentric axes.
Matrix3d EnuFromEarth(const GeodeticPoint& point) {
  const double sin_latitude = std::sin(point.latitude_rad);
  const double cos_latitude = std::cos(point.latitude_rad);
  const double sin_longitude = std::sin(point.longitude_rad);
  const double cos_longitude = std::cos(point.longitude_rad);
  Matrix3d rows;
  rows.row(0) << -sin_longitude, cos_longitude, 0;
  rows.row(1) << -sin_latitude * cos_longitude, -sin_latitude * sin_longitude, cos_latitude;
  rows.row(2) << cos_latitude * cos_longitude, cos_latitude * sin_longitude, sin_latitude;
  return rows;
}

}  // namespace

Vector3d EarthCenteredFromGeodetic(const GeodeticPoint& point) {
  Vector3d at;
  GeographicLib::Geocentric::WGS84().Forward(DegreesFromRadians(point.latitude_rad),
                                             DegreesFromRadians(point.longitude_rad), point.altitude_m, at.x(), at.y(),
                                             at.z());
  return at;
}

TangentPlane::TangentPlane(const GeodeticPoint& origin)
    : origin_(origin), origin_in_earth_m_(EarthCenteredFromGeodetic(origin)), enu_from_earth_(EnuFromEarth(origin)) {}

Vector3d TangentPlane::EnuFromGeodetic(const GeodeticPoint& point) const {
  return enu_from_earth_ * (EarthCenteredFromGeodetic(point) - origin_in_earth_m_);
}

GeodeticPoint TangentPlane::GeodeticFromEnu(const Vector3d& point_in_enu) const {
  return GeodeticFromEarthCentered(origin_in_earth_m_ + enu_from_earth_.transpose() * point_in_enu);
}

Eigen::Quaterniond TangentPlane::LocalEnuFromEnu(const Vector3d& point_in_enu) const {
  const Matrix3d turn = EnuFromEarth(GeodeticFromEnu(point_in_enu)) * enu_from_earth_.transpose();
  return Eigen::Quaterniond(turn);
}

}  // namespace victorious
