#include "victorious/input/telemetry/given_attitude.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr GeodeticPoint kStart{RadiansFromDegrees(47), RadiansFromDegrees(8), 500};

// States 30 times a second at these places relative to kStart.
std::vector<CameraState> At(const std::vector<Vector3d>& places_enu_m) {
  const TangentPlane plane(kStart);
  std::vector<CameraState> states;
  for (const Vector3d& place : places_enu_m) {
    CameraState& state = states.emplace_back();
    state.time_s = static_cast<double>(states.size()) / 30;
    state.place = plane.GeodeticFromEnu(place);
  }
  return states;
}

// The yaws of the states along their course, degrees; 999: none.
std::vector<double> Yaws(std::vector<CameraState> states) {
  TelemetryOptions options;
  options.camera_pitch_deg = -60;
  std::vector<std::string> warnings;
  CompleteAttitudes(states, options, warnings);
  std::vector<double> yaws_deg;
  for (const CameraState& state : states)
    yaws_deg.push_back(state.attitude ? DegreesFromRadians(state.attitude->yaw_rad) : 999);
  return yaws_deg;
}

TEST(CompleteAttitudes, CourseIsTakenOverTwoMetres) {
  // East by 1.5 m, north by 3 m.
  const std::vector<double> yaws_deg = Yaws(At({{0, 0, 0}, {0.75, 0, 0}, {1.5, 0, 0}, {1.5, 1.5, 0}, {1.5, 3, 0}}));
  const auto course_deg = [](double east_m, double north_m) { return DegreesFromRadians(std::atan2(east_m, north_m)); };
  ASSERT_EQ(yaws_deg.size(), 5U);
  EXPECT_NEAR(yaws_deg[0], course_deg(1.5, 1.5), 1e-3);
  EXPECT_NEAR(yaws_deg[1], course_deg(0.75, 3), 1e-3);
  EXPECT_NEAR(yaws_deg[2], 0, 1e-3);
  EXPECT_EQ(yaws_deg[3], yaws_deg[2]) << "the last course";
  EXPECT_EQ(yaws_deg[4], yaws_deg[2]);
}

// Half an hour, in which a scan from each state to the end of the hover took 1.25e9 conversions.
TEST(CompleteAttitudes, LongHoverLooksWhereTheFlightGoesOn) {
  constexpr int kHover = 50'000;
  std::vector<Vector3d> places;
  for (int i = 0; i < kHover; ++i) places.emplace_back(0.5 * std::sin(i), 0.5 * std::cos(0.7 * i), 0);
  for (int i = 0; i < 100; ++i) places.emplace_back(0.3 * i, 0, 0);
  const std::vector<double> yaws_deg = Yaws(At(places));
  for (int i = 0; i < kHover; i += 100) EXPECT_NEAR(yaws_deg[i], 90, 20) << i;
  EXPECT_NEAR(yaws_deg.back(), 90, 0.01);
}

TEST(CompleteAttitudes, CameraThatNeverMovesHasNone) {
  std::vector<CameraState> states = At({{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}});
  TelemetryOptions options;
  options.camera_pitch_deg = -60;
  std::vector<std::string> warnings;
  CompleteAttitudes(states, options, warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("--yaw"), std::string::npos);
  EXPECT_FALSE(states[0].attitude);
}

}  // namespace
}  // namespace victorious
