#include "victorious/geometry/geodesy.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

GeodeticPoint Place(double latitude_deg, double longitude_deg, double altitude_m) {
  return {RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg), altitude_m};
}

TEST(TangentPlane, AxesAreEastNorthUp) {
  const TangentPlane plane(Place(42, -71, 10));
  EXPECT_LT(plane.EnuFromGeodetic(Place(42, -71, 10)).norm(), 1e-6);
  EXPECT_NEAR(plane.EnuFromGeodetic(Place(42, -71, 35)).z(), 25, 1e-6);
  // A ten-thousandth of a degree of latitude is 11.1 m, of longitude 11.1 cos 42 m.
  EXPECT_LT((plane.EnuFromGeodetic(Place(42.0001, -71, 10)) - Vector3d(0, 11.108, 0)).norm(), 2e-3);
  EXPECT_LT((plane.EnuFromGeodetic(Place(42, -70.9999, 10)) - Vector3d(8.286, 0, 0)).norm(), 2e-3);
}

TEST(TangentPlane, RoundTripsEverywhereOnEarth) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const TangentPlane plane(Place(random.Uniform(-89, 89), random.Uniform(-180, 180), random.Uniform(-100, 5000)));
    const Vector3d point(random.Uniform(-3000, 3000), random.Uniform(-3000, 3000), random.Uniform(-100, 3000));
    EXPECT_LT((plane.EnuFromGeodetic(plane.GeodeticFromEnu(point)) - point).norm(), 1e-6);
  }
}

TEST(TangentPlane, LocalAxesAreThoseOfTheirOwnPlane) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const TangentPlane plane(Place(random.Uniform(-89, 89), random.Uniform(-180, 180), random.Uniform(-100, 5000)));
    const Vector3d point(random.Uniform(-3000, 3000), random.Uniform(-3000, 3000), random.Uniform(-100, 3000));
    const Vector3d apart(random.Uniform(-9, 9), random.Uniform(-9, 9), random.Uniform(-9, 9));
    const TangentPlane local(plane.GeodeticFromEnu(point));
    const Vector3d in_local = local.EnuFromGeodetic(plane.GeodeticFromEnu(point + apart));
    EXPECT_LT((plane.LocalEnuFromEnu(point) * apart - in_local).norm(), 1e-6);
  }
}

TEST(TangentPlane, AxesFollowTheMeridian) {
  const TangentPlane plane(Place(60, 20, 0));
  const Vector3d east_km(1000, 0, 0);
  const Eigen::Quaterniond turn = plane.LocalEnuFromEnu(east_km);
  // For a displacement to the east, the local north is rotated to the left of the origin's: by the longitude times sin
  // 60.
  const double longitude_rad = plane.GeodeticFromEnu(east_km).longitude_rad - plane.origin().longitude_rad;
  const Vector3d origin_north = turn * Vector3d::UnitY();
  EXPECT_NEAR(std::atan2(origin_north.x(), origin_north.y()), longitude_rad * std::sin(RadiansFromDegrees(60)), 1e-7);
  // The local up is tilted by the displacement over the Earth's radius.
  EXPECT_NEAR((turn * Vector3d::UnitZ()).x(), -1000 / 6.39e6, 1e-6);
}

}  // namespace
}  // namespace victorious
