#include "victorious/geometry/sun.h"

#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

Sun SunAt(std::int64_t utc_us, const GeodeticPoint& place) {
  constexpr double kMicrosecondsPerDay = 86400e6;
  constexpr double kNoonOfYear2000 = 10957.5;  // 2000-01-01 12:00 UTC, in days since 1970
  const double days = static_cast<double>(utc_us) / kMicrosecondsPerDay - kNoonOfYear2000;
  const double mean_longitude = RadiansFromDegrees(280.460 + 0.9856474 * days);
  const double anomaly = RadiansFromDegrees(357.528 + 0.9856003 * days);
  const double longitude = mean_longitude + RadiansFromDegrees(1.915) * std::sin(anomaly) +
                           RadiansFromDegrees(0.020) * std::sin(2 * anomaly);
  const double obliquity = RadiansFromDegrees(23.439 - 0.0000004 * days);
  const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  const double sidereal = RadiansFromDegrees(280.46062 + 360.98564737 * days) + place.longitude_rad;
  const double hour = sidereal - right_ascension;
  const double up = std::sin(place.latitude_rad) * std::sin(declination) +
                    std::cos(place.latitude_rad) * std::cos(declination) * std::cos(hour);
  const double east = -std::cos(declination) * std::sin(hour);
  const double north = std::cos(place.latitude_rad) * std::sin(declination) -
                       std::sin(place.latitude_rad) * std::cos(declination) * std::cos(hour);
  const double azimuth = std::atan2(east, north);
  return {.azimuth_rad = azimuth < 0 ? azimuth + 2 * kPi : azimuth,
          .elevation_rad = std::atan2(up, std::hypot(east, north))};
}

}  // namespace victorious
