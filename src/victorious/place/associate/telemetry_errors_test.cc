#include "victorious/place/associate/telemetry_errors.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/median.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/associate/simulated_tracklet_test.h"

namespace victorious {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// A flight past standing objects. Its telemetry has errors of each row and of the whole flight, in units of the
// supposed standard deviations: 2 m, 0.5 degrees.
struct NoisyFlight {
  std::uint64_t seed = 1;
  double position = 1;
  double attitude = 1;
  int frames = 40;
  Vector3d velocity_enu{0, 0, 0};  // of the last objects
  std::size_t driving = 1;         // their number
};

const std::vector<Vector3d> kPlaces = {{0, 0, 1}, {12, -8, 1}, {-15, 6, 1}, {4, 14, 1}};

std::vector<ObservedTracklet> Simulate(const NoisyFlight& flight) {
  const ObjectOptions options;
  Random random(flight.seed);
  const auto normals = [&](double sigma) {
    const double x = random.Normal();
    const double y = random.Normal();
    const double z = random.Normal();
    return Vector3d(sigma * Vector3d(x, y, z));
  };
  const double position_m = flight.position * options.locate.common.position_m;
  const double attitude_rad = flight.attitude * RadiansFromDegrees(options.locate.common.heading_deg);
  const Vector3d position_of_flight = normals(position_m);
  const Vector3d attitude_of_flight = normals(attitude_rad);
  std::vector<ObservedTracklet> tracklets;
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const auto id = static_cast<std::int64_t>(i) + 1;
    tracklets.push_back(
        SimulateTracklet({.id = id + 100 * static_cast<std::int64_t>(flight.seed),
                          .model = id,
                          .place_enu = kPlaces[i],
                          .velocity_enu = i + flight.driving >= kPlaces.size() ? flight.velocity_enu : Vector3d::Zero(),
                          .frames = flight.frames,
                          .noise_rad = 2e-4,
                          .camera_from_m = -60,
                          .camera_speed_m_s = 120 / (kFrameS * flight.frames)}));
    tracklets.back().has_filtered_telemetry = false;
  }
  const TangentPlane plane(kOrigin);
  for (int frame = 0; frame < flight.frames; ++frame) {
    const Vector3d of_row_m = position_of_flight + normals(position_m);
    const Vector3d of_row_rad = attitude_of_flight + normals(attitude_rad);
    for (ObservedTracklet& tracklet : tracklets) {
      LineOfSight& line = tracklet.observations[static_cast<std::size_t>(frame)].line;
      line.camera = plane.GeodeticFromEnu(plane.EnuFromGeodetic(line.camera) + of_row_m);
      line.azimuth_rad += of_row_rad.x();
      line.elevation_rad += of_row_rad.y();
    }
  }
  return tracklets;
}

// Of the first object.
struct FirstError {
  double error_m = 0;  // horizontal
  double ce90_m = 0;
};

FirstError LocateFirst(std::vector<ObservedTracklet> tracklets, const ObjectOptions& options) {
  if (const auto errors = EstimateTelemetryErrors(tracklets, options)) SetTelemetryErrors(*errors, options, tracklets);
  const ObjectPlace found = EstimatePlace(tracklets[0].observations, options, 1);
  if (!found.place) return {.error_m = 1e9, .ce90_m = 0};
  const Vector3d error_m = TangentPlane(kOrigin).EnuFromGeodetic(found.place->point) - kPlaces[0];
  return {.error_m = error_m.head<2>().norm(), .ce90_m = found.place->ce90_m};
}

TEST(TelemetryErrors, FollowFromTheLinesOfTheFlight) {
  for (const double truth : {0.2, 1.0, 3.0}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const auto errors = EstimateTelemetryErrors(Simulate({.seed = seed, .position = truth, .attitude = truth}), {});
      ASSERT_TRUE(errors);
      EXPECT_NEAR(std::log(errors->position.ratio), std::log(truth), std::log(1.7)) << truth << ", seed " << seed;
      EXPECT_NEAR(std::log(errors->attitude.ratio), std::log(truth), std::log(1.7)) << truth << ", seed " << seed;
      EXPECT_TRUE(errors->position.is_measured);
      EXPECT_EQ(errors->objects, 4);
      EXPECT_EQ(errors->frames, 40);
    }
  }
}

TEST(TelemetryErrors, OfExactTelemetryAreSmall) {
  const auto errors = EstimateTelemetryErrors(Simulate({.position = 0, .attitude = 0}), {});
  ASSERT_TRUE(errors);
  EXPECT_LT(errors->position.ratio, 0.1);
  EXPECT_LT(errors->attitude.ratio, 0.1);
}

TEST(TelemetryErrors, AnObjectThatDrivesIsNoError) {
  const auto errors =
      EstimateTelemetryErrors(Simulate({.position = 0.1, .attitude = 0.1, .velocity_enu = {8, 3, 0}}), {});
  ASSERT_TRUE(errors);
  EXPECT_LT(errors->position.ratio, 0.3);
  EXPECT_EQ(errors->objects, 3);
}

// As on a road: what is usual is the velocity of the traffic, not that of the ground.
TEST(TelemetryErrors, TrafficAlongOneRoadIsNoError) {
  for (const std::size_t driving : {std::size_t{3}, kPlaces.size()}) {
    const NoisyFlight flight{.position = 0, .attitude = 0, .velocity_enu = {4, 5, 0}, .driving = driving};
    const auto errors = EstimateTelemetryErrors(Simulate(flight), {});
    if (driving == kPlaces.size()) {
      EXPECT_FALSE(errors) << "nothing stands";
      continue;
    }
    ASSERT_TRUE(errors);
    EXPECT_EQ(errors->objects, 1);
    EXPECT_LT(errors->position.ratio, 0.1);
    EXPECT_LT(errors->attitude.ratio, 0.1);
  }
}

TEST(TelemetryErrors, AreSupposedWhereTheFlightSaysNothing) {
  EXPECT_FALSE(EstimateTelemetryErrors({}, {}));
  EXPECT_FALSE(EstimateTelemetryErrors(Simulate({.frames = kMinErrorFrames - 1}), {}));
  ObjectOptions supposed;
  supposed.telemetry_errors = ErrorSource::kSupposed;
  EXPECT_FALSE(EstimateTelemetryErrors(Simulate({}), supposed));
  std::vector<ObservedTracklet> stated = Simulate({});
  stated[0].observations[0].sigma_position_m = 0.02;
  EXPECT_TRUE(EstimateTelemetryErrors(stated, {})) << "of a row that is older than the others";
  for (BearingObservation& observation : stated[0].observations) observation.sigma_position_m = 0.02;
  EXPECT_FALSE(EstimateTelemetryErrors(stated, {})) << "telemetry that states its errors";
}

// A receiver that filters its positions has rows that agree, and all of them may be metres off.
TEST(TelemetryErrors, FilteredRowsLeaveCommonErrorsUnknown) {
  std::vector<ObservedTracklet> tracklets = Simulate({.position = 0, .attitude = 0});
  const double exact_m = LocateFirst(tracklets, {}).ce90_m;
  EXPECT_LT(exact_m, 0.5);
  for (ObservedTracklet& tracklet : tracklets) tracklet.has_filtered_telemetry = true;
  EXPECT_GT(LocateFirst(tracklets, {}).ce90_m, 3.5);
  for (ObservedTracklet& tracklet : tracklets) tracklet.has_filtered_telemetry = false;
  ObjectOptions rows;
  rows.telemetry_errors = ErrorSource::kRows;
  EXPECT_GT(LocateFirst(tracklets, rows).ce90_m, 3.5);
}

// 90 % of the true places lie within CE90, whatever the size of the errors; and CE90 is not far wider than the errors.
TEST(TelemetryErrors, Ce90CoversAndIsNotTooWide) {
  constexpr int kFlights = 20;
  for (const double truth : {0.2, 1.0, 3.0}) {
    int inside = 0;
    std::vector<double> shares;
    for (std::uint64_t seed = 1; seed <= kFlights; ++seed) {
      const FirstError place = LocateFirst(Simulate({.seed = seed, .position = truth, .attitude = truth}), {});
      inside += place.error_m <= place.ce90_m ? 1 : 0;
      shares.push_back(place.error_m / place.ce90_m);
    }
    EXPECT_GE(inside, 15) << truth;  // of 20 draws with 90 %, fewer in 1 of 100 cases
    EXPECT_GT(Median(shares), 0.3) << truth;
  }
}

TEST(TelemetryErrors, AreSaidWithWhatTheyRestOn) {
  const ObjectOptions options;
  const std::vector<std::string> supposed = DescribeErrors(std::nullopt, options);
  ASSERT_EQ(supposed.size(), 2U);
  EXPECT_EQ(supposed[0], "position: 2 m, assumed");
  EXPECT_EQ(supposed[1], "attitude: 0.5 degrees, assumed");
  const auto errors = EstimateTelemetryErrors(Simulate({.position = 0.2, .attitude = 0.2}), options);
  ASSERT_TRUE(errors);
  EXPECT_THAT(DescribeErrors(errors, options).at(1), HasSubstr("measured on 4 objects and 40 frames"));
}

}  // namespace
}  // namespace victorious
