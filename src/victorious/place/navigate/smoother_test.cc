#include "victorious/place/navigate/smoother.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"

namespace victorious {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d RandomVector(Random& random, double sigma) {
  return sigma * Vector3d(random.Normal(), random.Normal(), random.Normal());
}

FlightState RandomState(Random& random) {
  FlightState state;
  state.camera_from_enu = RotationFromVector(RandomVector(random, 1));
  state.place = RandomVector(random, 50);
  return state;
}

TEST(Smoother, SightingJacobianMatchesFiniteDifferences) {
  Random random(3);
  for (int draw = 0; draw < 20; ++draw) {
    const FlightState state = RandomState(random);
    const Rigid3 landmark{RotationFromVector(RandomVector(random, 1)), RandomVector(random, 50)};
    const Rigid3 seen{state.camera_from_enu * landmark.rotation,
                      state.camera_from_enu * (landmark.translation - state.place)};
    const SightingJacobian jacobian = ComputeSightingJacobian(state, landmark);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 6; ++i) {
      FlightState moved = state;
      Rigid3 moved_landmark = landmark;
      const Vector3d step = kStep * Vector3d::Unit(i % 3);
      if (i < 3) {
        moved.camera_from_enu = RotationFromVector(step) * state.camera_from_enu;
        moved_landmark.rotation = RotationFromVector(step) * landmark.rotation;
      } else {
        moved.place += step;
        moved_landmark.translation += step;
      }
      EXPECT_LT((SightingError(seen, moved, landmark) / kStep - jacobian.by_state.col(i)).norm(), 1e-3) << i;
      EXPECT_LT((SightingError(seen, state, moved_landmark) / kStep - jacobian.by_landmark.col(i)).norm(), 1e-3) << i;
    }
  }
}

// A static camera, one exact landmark, no telemetry: observed in the first and the last frame.
TEST(Smoother, InterpolatesFramesWithoutSightings) {
  Random random(5);
  const FlightState truth = RandomState(random);
  const Rigid3 landmark{RotationFromVector(RandomVector(random, 1)),
                        truth.place + truth.camera_from_enu.conjugate() * Vector3d(1, 2, 90)};
  FlightInput flight;
  for (int k = 0; k < 11; ++k) flight.frames.push_back({1.0 * k, std::nullopt});
  flight.sigmas = {.speed_m_s = 10, .speed_change_m_s = 1, .angular_rate_rad_s = 0.2, .angular_rate_change_rad_s = 0.1};
  Matrix6 information = Matrix6::Identity() * 1e4;
  const Rigid3 seen{truth.camera_from_enu * landmark.rotation,
                    truth.camera_from_enu * (landmark.translation - truth.place)};
  const std::vector<SightingConstraint> constraints = {{0, 0, seen, information}, {10, 0, seen, information}};
  const std::vector<FlightLandmark> landmarks = {{landmark, Matrix6::Identity() * 1e-6}};
  FlightState start = truth;
  start.place += Vector3d(5, -4, 3);
  start.camera_from_enu = RotationFromVector(Vector3d(0.1, -0.05, 0.1)) * start.camera_from_enu;
  const auto smoothed = SmoothFlight(flight, landmarks, constraints, std::vector<FlightState>(11, start));
  ASSERT_TRUE(smoothed);
  for (const FlightState& state : smoothed->states) {
    EXPECT_LT((state.place - truth.place).norm(), 1e-3);
    EXPECT_LT(state.camera_from_enu.angularDistance(truth.camera_from_enu), 1e-5);
  }
  const auto sigma = [&](std::size_t k) { return std::sqrt(smoothed->covariances.blocks[k](3, 3)); };
  EXPECT_GT(sigma(5), sigma(0));
  EXPECT_NEAR(sigma(0), sigma(10), 1e-3 * sigma(0));
}

TEST(Smoother, SeparatesOffsetsFromNoise) {
  Random random(7);
  FlightInput flight{.frames = {},
                     .sigmas = {.offset_position_m = 10,
                                .offset_attitude_rad = 0.05,
                                .drift_position_m = 0.01,
                                .drift_attitude_rad = 1e-4,
                                .speed_m_s = 10,
                                .speed_change_m_s = 0.1,
                                .angular_rate_rad_s = 0.2,
                                .angular_rate_change_rad_s = 0.1},
                     .has_telemetry = true};
  FlightState truth;
  const Attitude attitude{1.2, -0.9, 0.1};
  truth.camera_from_enu = CameraFromEnu(attitude);
  const Vector3d place_offset(6, -3, 8);
  const Vector3d attitude_offset(0.03, -0.02, 0.05);
  const Rigid3 landmark{Quaterniond::Identity(), truth.camera_from_enu.conjugate() * Vector3d(1, 2, 90)};
  const Rigid3 seen{truth.camera_from_enu, Vector3d(1, 2, 90)};
  std::vector<SightingConstraint> constraints;
  for (std::size_t k = 0; k < 50; ++k) {
    const Vector3d measured = place_offset + RandomVector(random, 0.5);
    const Vector3d turned = attitude_offset + RandomVector(random, 0.01);
    flight.frames.push_back(
        {0.1 * static_cast<double>(k),
         TelemetryPose{measured,
                       {attitude.yaw_rad + turned[0], attitude.pitch_rad + turned[1], attitude.roll_rad + turned[2]},
                       Quaterniond::Identity(),
                       0.5,
                       0.01}});
    constraints.push_back({k, 0, seen, Matrix6::Identity() * 1e6});
  }
  const std::vector<FlightLandmark> landmarks = {{landmark, Matrix6::Identity() * 1e-8}};
  std::vector<FlightState> start(50);
  for (std::size_t k = 0; k < start.size(); ++k) {
    start[k].place = flight.frames[k].measured->place;
    start[k].camera_from_enu = flight.frames[k].measured->CorrectedCameraFromEnu(Vector3d::Zero());
  }
  const auto smoothed = SmoothFlight(flight, landmarks, constraints, start);
  ASSERT_TRUE(smoothed);
  const FlightState& state = smoothed->states[25];
  EXPECT_LT(state.place.norm(), 0.02);
  EXPECT_LT((state.place_offset - place_offset).norm(), 4 * 0.5 * std::sqrt(3.0 / 50));
  EXPECT_LT((state.attitude_offset - attitude_offset).norm(), 4 * 0.01 * std::sqrt(3.0 / 50));
}

}  // namespace
}  // namespace victorious
