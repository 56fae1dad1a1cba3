#include "victorious/geometry/sun.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

GeodeticPoint SunPlace(double latitude_deg, double longitude_deg) {
  return {RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg), 0};
}

// Noon at Greenwich on the March equinox of 2000 (20th, 7:35): the sun on the equator, which it crossed north 4.4 hours
// ago at 0.99 arc minutes an hour; the equation of time is -7.5 minutes, 1.9 degrees east of the meridian.
TEST(Sun, IsAboveTheEquatorAtTheEquinox) {
  const Sun sun = SunAt(953'553'600 * kSecond, SunPlace(0, 0));
  EXPECT_NEAR(DegreesFromRadians(sun.elevation_rad), 88.1, 0.1);
  EXPECT_NEAR(DegreesFromRadians(sun.azimuth_rad), 88, 2.5);
}

// At the June solstice of 2020 (20th, 21:44) the sun stands 23.44 degrees north: on Greenwich's meridian at 12:01:48.
TEST(Sun, CulminatesDueSouthAtTheSolstice) {
  const Sun sun = SunAt(1'592'654'508 * kSecond, SunPlace(51.4779, 0));
  EXPECT_NEAR(DegreesFromRadians(sun.elevation_rad), 90 - 51.4779 + 23.436, 0.03);
  EXPECT_NEAR(DegreesFromRadians(sun.azimuth_rad), 180, 0.2);
}

TEST(Sun, RisesInTheEastAndSetsInTheWest) {
  const std::int64_t noon = 953'553'600 * kSecond;
  EXPECT_NEAR(DegreesFromRadians(SunAt(noon - 6 * 3600 * kSecond, SunPlace(45, 0)).azimuth_rad), 90, 3);
  EXPECT_NEAR(DegreesFromRadians(SunAt(noon + 6 * 3600 * kSecond, SunPlace(45, 0)).azimuth_rad), 270, 3);
  EXPECT_LT(SunAt(noon + 12 * 3600 * kSecond, SunPlace(45, 0)).elevation_rad, RadiansFromDegrees(-40));
}

}  // namespace
}  // namespace victorious
