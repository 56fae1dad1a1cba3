#include "victorious/place/geolocate/flight_shift.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const TangentPlane kPlane({RadiansFromDegrees(48), RadiansFromDegrees(11), 500});

// The line from a camera that sees the object under these errors of its clock.
LineOfSight Line(double time_s, const Vector3d& camera, const Vector3d& object, const ClockShift& shift) {
  const Vector3d to = object - camera;
  return {.time_s = time_s,
          .camera = kPlane.GeodeticFromEnu(camera),
          .azimuth_rad = std::atan2(to.x(), to.y()),
          .elevation_rad = std::asin(to.z() / to.norm()),
          .clock_shift = shift};
}

Geolocation Place(const Vector3d& object) {
  return {.point = kPlane.GeodeticFromEnu(object), .covariance_enu_m2 = 0.01 * Eigen::Matrix3d::Identity()};
}

TEST(ClockShift, MovesAPlaceWithTheCamera) {
  std::vector<LineOfSight> lines;
  for (int i = 0; i < 50; ++i)
    lines.push_back(Line(0.1 * i, {i - 25.0, -75, 100}, {0, 0, 0}, {.camera_enu_m = {20, 0, 0}}));
  Geolocation place = Place({0, 0, 0});
  AddFlightErrors(lines, std::vector<bool>(50, true), false, place);
  EXPECT_NEAR(place.covariance_enu_m2(0, 0), 400, 0.1);
  EXPECT_NEAR(place.covariance_enu_m2(1, 1), 0.01, 1e-6);
  EXPECT_NEAR(place.ce90_m, 1.645 * 20, 0.1) << "an error along one axis";
}

// A camera that turns its gaze with its motion around the object moves no place there.
TEST(ClockShift, OfACircleAroundTheObjectIsNone) {
  std::vector<LineOfSight> lines;
  constexpr double kTurn_rad = 0.4;  // by one standard deviation
  for (int i = 0; i < 50; ++i) {
    const double angle = 0.03 * i;
    const Vector3d camera(75 * std::sin(angle), -75 * std::cos(angle), 100);
    const Vector3d moved = kTurn_rad * Vector3d(75 * std::cos(angle), 75 * std::sin(angle), 0);
    lines.push_back(Line(0.1 * i, camera, {0, 0, 0}, {.camera_enu_m = moved, .azimuth_rad = -kTurn_rad}));
  }
  Geolocation place = Place({0, 0, 0});
  AddFlightErrors(lines, std::vector<bool>(50, true), false, place);
  EXPECT_NEAR(place.covariance_enu_m2(0, 0), 0.01, 1e-3);
  EXPECT_NEAR(place.covariance_enu_m2(1, 1), 0.01, 1e-3);
}

// A single line that rises by 0.01 rad meets the ground farther away.
TEST(ClockShift, KeepsAnObjectOnItsGround) {
  const std::vector<LineOfSight> lines = {Line(0, {0, -100, 100}, {0, 0, 0}, {.elevation_rad = 0.01})};
  Geolocation place = Place({0, 0, 0});
  AddFlightErrors(lines, {true}, true, place);
  const double expected_m = 100 - 100 / std::tan(kPi / 4 + 0.01);
  EXPECT_NEAR(std::sqrt(place.covariance_enu_m2(1, 1)), std::abs(expected_m), 0.15);
  EXPECT_LT(place.covariance_enu_m2(2, 2), 0.1);
}

TEST(ClockShift, OutliersDoNotCount) {
  std::vector<LineOfSight> lines;
  std::vector<bool> inliers;
  for (int i = 0; i < 20; ++i) {
    for (const bool is_inlier : {true, false}) {
      const double shift_m = is_inlier ? 10 : -10;
      lines.push_back(Line(0.1 * i, {i - 10.0, -75, 100}, {0, 0, 0}, {.camera_enu_m = {shift_m, 0, 0}}));
      inliers.push_back(is_inlier);
    }
  }
  Geolocation place = Place({0, 0, 0});
  AddFlightErrors(lines, inliers, false, place);
  EXPECT_NEAR(place.covariance_enu_m2(0, 0), 100, 0.2);
  Geolocation without = Place({0, 0, 0});
  AddFlightErrors(lines, std::vector<bool>(40, false), false, without);
  EXPECT_EQ(without.covariance_enu_m2, Place({0, 0, 0}).covariance_enu_m2);
}

// Ranges that are too long by a tenth, past a camera that flies straight.
TEST(FocalShift, MovesAPlaceAwayFromTheCamera) {
  std::vector<LineOfSight> lines;
  for (int i = 0; i < 50; ++i) {
    lines.push_back(Line(0.1 * i, {0.02 * i - 0.5, -75, 100}, {0, 0, 0}, {}));
    lines.back().clock_shift.reset();
    lines.back().range_m = 125;
    lines.back().focal_shift = FocalShift{.sigma = 0.1};
  }
  Geolocation place = Place({0, 0, 0});
  AddFlightErrors(lines, std::vector<bool>(50, true), false, place);
  EXPECT_NEAR(std::sqrt(place.covariance_enu_m2(1, 1)), 7.5, 0.1);
  EXPECT_NEAR(std::sqrt(place.covariance_enu_m2(2, 2)), 10, 0.1);
  EXPECT_LT(place.covariance_enu_m2(0, 0), 0.1);

  for (LineOfSight& line : lines) line.range_m.reset();
  Geolocation of_lines = Place({0, 0, 0});
  AddFlightErrors(lines, std::vector<bool>(50, true), false, of_lines);
  EXPECT_NEAR(of_lines.covariance_enu_m2(1, 1), 0.01, 1e-6) << "lines on the optical axis do not turn";
}

// Of a camera that circles, errors of the ranges move the place to all sides.
TEST(FocalShift, OfACircleAroundTheObjectMovesItLittle) {
  std::vector<LineOfSight> lines;
  for (int i = 0; i < 100; ++i) {
    const double angle = 2 * kPi * i / 100;
    lines.push_back(Line(0.1 * i, {75 * std::sin(angle), -75 * std::cos(angle), 100}, {0, 0, 0}, {}));
    lines.back().clock_shift.reset();
    lines.back().range_m = 125;
    lines.back().focal_shift = FocalShift{.sigma = 0.1};
  }
  Geolocation place = Place({0, 0, 0});
  AddFlightErrors(lines, std::vector<bool>(100, true), false, place);
  EXPECT_LT(std::sqrt(place.covariance_enu_m2(0, 0)), 0.2);
  EXPECT_LT(std::sqrt(place.covariance_enu_m2(1, 1)), 0.2);
}

TEST(ClockShift, APathIsShiftedAsItsCameraThen) {
  std::vector<LineOfSight> lines;
  for (int i = 0; i < 100; ++i) {
    const Vector3d moved = i < 50 ? Vector3d(20, 0, 0) : Vector3d(0, 10, 0);
    lines.push_back(Line(0.1 * i, {0, -75, 100}, {0, 0, 0}, {.camera_enu_m = moved}));
  }
  std::vector<Geolocation> path = {Place({0, 0, 0}), Place({0, 0, 0})};
  path[1].time_s = 9;
  AddFlightErrors(lines, std::vector<bool>(100, true), false, std::span(path));
  EXPECT_NEAR(path[0].covariance_enu_m2(0, 0), 400, 1);
  EXPECT_NEAR(path[1].covariance_enu_m2(1, 1), 100, 1);
}

}  // namespace
}  // namespace victorious
