#include "victorious/lab/evaluate/place_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::DoubleNear;
using ::testing::Optional;

const GeodeticPoint kPoint{0.9, 0.2, 80};

TruthRow Truth() { return {.place = kPoint, .heading_rad = RadiansFromDegrees(350)}; }

Geolocation PlaceOff(const Eigen::Vector3d& off_m, double variance_m2) {
  return {.point = TangentPlane(kPoint).GeodeticFromEnu(off_m),
          .covariance_enu_m2 = variance_m2 * Eigen::Matrix3d::Identity(),
          .ce90_m = 2.146 * std::sqrt(variance_m2)};
}

TEST(PlaceScore, HorizontalAndSpatialErrors) {
  const PlaceError error = ComputePlaceError(PlaceOff({3, 4, 12}, 100), std::nullopt, Truth());
  EXPECT_THAT(error.horizontal_error_m, Optional(DoubleNear(5, 1e-6)));
  EXPECT_THAT(error.spatial_error_m, Optional(DoubleNear(13, 1e-6)));
  EXPECT_TRUE(error.in_ce90);
  EXPECT_FALSE(error.heading_rad);
}

TEST(PlaceScore, EllipsoidBoundaryIsNinetyPercent) {
  EXPECT_TRUE(ComputePlaceError(PlaceOff({0, 2.49, 0}, 1), std::nullopt, Truth()).in_ellipsoid);
  EXPECT_FALSE(ComputePlaceError(PlaceOff({0, 2.51, 0}, 1), std::nullopt, Truth()).in_ellipsoid);
  EXPECT_FALSE(ComputePlaceError(PlaceOff({0, 0, 0}, 0), std::nullopt, Truth()).in_ellipsoid) << "no covariance";
}

TEST(PlaceScore, HeadingErrorIsTheSmallerAngle) {
  EXPECT_THAT(ComputePlaceError(std::nullopt, RadiansFromDegrees(15), Truth()).heading_rad,
              Optional(DoubleNear(RadiansFromDegrees(25), 1e-12)));
}

TEST(PlaceScore, MissingPlaceOrTruthIsSkipped) {
  EXPECT_FALSE(ComputePlaceError(std::nullopt, std::nullopt, Truth()).horizontal_error_m);
  EXPECT_FALSE(ComputePlaceError(PlaceOff({0, 0, 0}, 1), 1.0, {}).horizontal_error_m);
}

}  // namespace
}  // namespace victorious
