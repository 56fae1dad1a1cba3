#include "victorious/place/associate/flight_errors.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// Seen for 8 s from a camera that circles by 120 degrees, with a yaw that is off and ranges of a wrong field of view.
ObservedTracklet Seen(std::int64_t video, std::int64_t id, const Vector3d& place, double yaw_error_deg,
                      double range_factor, int frames = 80) {
  Random random(static_cast<std::uint64_t>(id));
  const TangentPlane plane({RadiansFromDegrees(48), RadiansFromDegrees(11), 500});
  ObservedTracklet tracklet{.record = {.id = id, .object = id, .video = video, .model = id}};
  for (int frame = 0; frame < frames; ++frame) {
    const double angle_rad = 0.026 * frame;
    const Vector3d camera(75 * std::sin(angle_rad), -75 * std::cos(angle_rad), 100);
    const Vector3d line = place - camera;
    BearingObservation observation;
    observation.line = {
        .time_s = 0.1 * frame,
        .camera = plane.GeodeticFromEnu(camera),
        .azimuth_rad = std::atan2(line.x(), line.y()) + RadiansFromDegrees(yaw_error_deg) + 1e-3 * random.Normal(),
        .elevation_rad = std::asin(line.z() / line.norm()) + 1e-3 * random.Normal(),
        .range_m = line.norm() * range_factor,
        .sigma_rad = 1e-3,
        .sigma_range_m = 2};
    tracklet.frames.push_back(frame);
    tracklet.observations.push_back(observation);
  }
  return tracklet;
}

TEST(CorrectFlight, CorrectsTheFlightThatIsWrong) {
  std::vector<ObservedTracklet> tracklets = {Seen(1, 1, {0, 0, 1}, 5, 1 / 1.2), Seen(1, 2, {8, 5, 1}, 5, 1 / 1.2),
                                             Seen(1, 3, {-16, 9, 2}, 5, 1 / 1.2)};
  std::vector<ObservedTracklet> again = tracklets;
  const double given_m = *tracklets[0].observations[0].line.range_m;
  const FlightEstimate estimate = CorrectFlight(tracklets, {});
  EXPECT_NEAR(DegreesFromRadians(estimate.errors.heading.value().error_rad), 5, 0.2);
  EXPECT_NEAR(estimate.errors.range.value().factor, 1.2, 0.03);
  EXPECT_NEAR(*tracklets[0].observations[0].line.range_m, 1.2 * given_m, 0.03 * given_m);
  EXPECT_NEAR(WrapAngle(tracklets[0].observations[0].line.azimuth_rad), 0, RadiansFromDegrees(0.5));
  EXPECT_TRUE(estimate.comparisons.empty()) << "of other ranges";

  Correct(estimate.errors, {}, again);
  EXPECT_EQ(again[1].observations[7].line.azimuth_rad, tracklets[1].observations[7].line.azimuth_rad);
  EXPECT_EQ(again[1].observations[7].line.range_m, tracklets[1].observations[7].line.range_m);
}

TEST(CorrectFlight, LeavesTheFlightThatIsRight) {
  std::vector<ObservedTracklet> tracklets = {Seen(2, 4, {0, 0, 1}, 0, 1), Seen(2, 5, {8, 5, 1}, 0, 1, 5)};
  const double azimuth_rad = tracklets[0].observations[7].line.azimuth_rad;
  const FlightEstimate estimate = CorrectFlight(tracklets, {});
  EXPECT_FALSE(estimate.errors.heading || estimate.errors.range);
  EXPECT_EQ(tracklets[0].observations[7].line.azimuth_rad, azimuth_rad);
  ASSERT_EQ(estimate.comparisons.size(), 2U);
  ASSERT_TRUE(estimate.comparisons[0] && *estimate.comparisons[0]);
  EXPECT_NEAR((*estimate.comparisons[0])->ratio, 1, 0.02);
  EXPECT_FALSE(estimate.comparisons[1]) << "too short to compare";
}

TEST(FlightErrors, AreSaidInNumbers) {
  const std::vector<std::string> lines = Describe({.heading = HeadingError{RadiansFromDegrees(-4.96), 3},
                                                   .range = RangeFactor{.factor = 1.2, .objects = 2},
                                                   .lengths = {{.model = 7, .factor = 0.5, .objects = 2}}},
                                                  {{7, "jeep"}});
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_TRUE(lines[0].starts_with("the lines of sight in 3 tracks")) << lines[0];
  EXPECT_TRUE(lines[0].contains("5.0 degrees too small")) << lines[0];
  EXPECT_TRUE(lines[1].contains("20 % too wide")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("jeep: 2 tracks would move")) << lines[2];
  EXPECT_TRUE(lines[2].contains("2.00 times too long")) << lines[2];
  EXPECT_TRUE(Describe({}, {}).empty());
}

}  // namespace
}  // namespace victorious
