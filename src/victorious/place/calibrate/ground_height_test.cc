#include "victorious/place/calibrate/ground_height.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/calibrate/filmed_ground_test.h"

namespace victorious {
namespace {

constexpr double kGround_m = 400;  // of the filmed ground
constexpr double kDepth_m = 110;   // of the ground below the cameras

CameraState CirclingOnePoint(double time_s) {
  const double turn_rad = 0.2 * time_s;
  return Above({-70 * std::sin(turn_rad), -70 * std::cos(turn_rad), kDepth_m}, DegreesFromRadians(turn_rad), -57.5, 0,
               time_s);
}

CameraState Climbing(double time_s) {
  return Above({4 * time_s, -60, kDepth_m + 3 * (time_s - 7.5)}, 0, -60, 0, time_s);
}

CameraState Hovering(double time_s) { return Above({0.02 * std::sin(time_s), -60, kDepth_m}, 0, -60, 0, time_s); }

// Its telemetry, with noise in each state.
CameraTrajectory Noisy(const FlightPath& path, double attitude_deg, double place_m) {
  Random random(11);
  std::vector<CameraState> states = RecordedLate(path, 0).states();
  for (CameraState& state : states) {
    for (double* angle_rad : {&state.attitude->yaw_rad, &state.attitude->pitch_rad, &state.attitude->roll_rad})
      *angle_rad += RadiansFromDegrees(attitude_deg) * random.Normal();
    const TangentPlane plane(state.place);
    state.place = plane.GeodeticFromEnu(place_m * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()));
  }
  return {std::move(states), 2};
}

TEST(GroundHeight, FollowsFromTheMotionOfTheGround) {
  for (const FlightPath& path :
       {FlightPath(Straight), FlightPath(Swerving), FlightPath(CirclingOnePoint), FlightPath(Climbing)}) {
    const auto ground = EstimateGroundHeight(Film(path), RecordedLate(path, 0));
    ASSERT_TRUE(ground);
    EXPECT_NEAR(ground->height_m, kGround_m, 0.02 * kDepth_m);
    EXPECT_GE(ground->sigma_m, 0.01 * kDepth_m) << "the ground is not flat";
    EXPECT_LT(ground->sigma_m, 0.04 * kDepth_m);
    EXPECT_EQ(ground->datum, VerticalDatum::kEllipsoid);
  }
}

TEST(GroundHeight, NoiseOfTelemetryIsWithinTheError) {
  for (const FlightPath& path : {FlightPath(Straight), FlightPath(Swerving), FlightPath(CirclingOnePoint)}) {
    const auto ground = EstimateGroundHeight(Film(path), Noisy(path, 0.1, 0.1));
    ASSERT_TRUE(ground);
    EXPECT_NEAR(ground->height_m, kGround_m, 0.03 * kDepth_m);
    EXPECT_NEAR(ground->height_m, kGround_m, 3 * ground->sigma_m);
  }
}

TEST(GroundHeight, IsUnknownIfTheCameraHardlyMoves) {
  for (const FlightPath& path : {FlightPath(Hovering), FlightPath(Rocking)}) {
    EXPECT_FALSE(EstimateGroundHeight(Film(path), RecordedLate(path, 0)));
    EXPECT_FALSE(EstimateGroundHeight(Film(path), Noisy(path, 0.1, 0.3)));
  }
  EXPECT_FALSE(EstimateGroundHeight(Film(Straight), Noisy(Straight, 0, 3))) << "noise of places hides the way";
}

TEST(GroundHeight, IsUnknownIfTelemetryDoesNotExplainTheMotion) {
  const auto otherwise = [](double time_s) { return Above({8 * time_s, -60, kDepth_m}, 40, -60, 0, time_s); };
  EXPECT_FALSE(EstimateGroundHeight(Film(Straight), RecordedLate(otherwise, 0)));
  EXPECT_FALSE(EstimateGroundHeight(Film(CirclingOnePoint), RecordedLate(Straight, 0)));
}

TEST(GroundHeight, NeedsAttitudesFieldsOfViewHeightsAndFourSeconds) {
  const ImageMotions seen = Film(Straight);
  const auto measured = [&](auto&& spoil) {
    std::vector<CameraState> states = RecordedLate(Straight, 0).states();
    for (CameraState& state : states) spoil(state);
    return EstimateGroundHeight(seen, CameraTrajectory(std::move(states), 2));
  };
  EXPECT_FALSE(measured([](CameraState& state) { state.attitude.reset(); }));
  EXPECT_FALSE(measured([](CameraState& state) { state.hfov_rad.reset(); }));
  EXPECT_FALSE(measured([](CameraState& state) { state.datum = VerticalDatum::kUnknown; }));
  const auto above_takeoff = measured([](CameraState& state) { state.datum = VerticalDatum::kTakeoff; });
  ASSERT_TRUE(above_takeoff);
  EXPECT_EQ(above_takeoff->datum, VerticalDatum::kTakeoff);
  EXPECT_FALSE(EstimateGroundHeight(seen, CameraTrajectory({}, 2)));
  ImageMotions short_one = seen;
  short_one.motions.resize(30);
  EXPECT_FALSE(EstimateGroundHeight(short_one, RecordedLate(Straight, 0)));
}

// The flight goes on after what was measured, lower than the ground there.
TEST(GroundHeight, IsThatOfThePartThatWasMeasured) {
  std::vector<CameraState> states = RecordedLate(Straight, 0).states();
  for (int i = 0; i < 600; ++i) states.push_back(Above({144 + 0.8 * i, -60, -200}, 0, -60, 0, 60 + 0.1 * i));
  const auto ground = EstimateGroundHeight(Film(Straight), CameraTrajectory(std::move(states), 2));
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->height_m, kGround_m, 0.02 * kDepth_m);
}

}  // namespace
}  // namespace victorious
