#include "victorious/place/associate/focal_error.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

struct FocalFlight {
  double log_factor = 0;  // of the true over the given focal length
  double given_sigma = 0.1;
  double view_noise_rad = 0.01;
};

// An object on the ground, seen for 4 s from a camera that flies straight north and looks 45 degrees down.
ObservedTracklet SeenWithFocalLength(std::int64_t id, const Vector3d& place, const FocalFlight& flight,
                                     double turns_rad_s = 0) {
  Random random(static_cast<std::uint64_t>(id));
  const TangentPlane plane({RadiansFromDegrees(48), RadiansFromDegrees(11), 500});
  const Eigen::AngleAxisd body(0.7 * static_cast<double>(id), Vector3d(0.1, 0, 1).normalized());
  ObservedTracklet tracklet{.record = {.id = id, .object = id, .video = 1, .model = id}};
  for (int frame = 0; frame < 40; ++frame) {
    const double time_s = 0.1 * frame;
    const Vector3d camera(0, -110 + 5 * time_s, 100);
    const Vector3d line = place - camera;
    const double azimuth_rad = std::atan2(line.x(), line.y());
    const double elevation_rad = std::asin(line.z() / line.norm());
    BearingObservation observation;
    // Angles off the axis are proportional to one over the focal length.
    FocalShift shift{.sigma = 1, .azimuth_rad = -azimuth_rad, .elevation_rad = -(elevation_rad + kPi / 4)};
    observation.line = {.time_s = time_s,
                        .camera = plane.GeodeticFromEnu(camera),
                        .azimuth_rad = azimuth_rad - flight.log_factor * shift.azimuth_rad,
                        .elevation_rad = elevation_rad - flight.log_factor * shift.elevation_rad,
                        .range_m = line.norm() * std::exp(-flight.log_factor),
                        .sigma_rad = 1e-3,
                        .sigma_range_m = 2};
    for (double* value : {&shift.sigma, &shift.azimuth_rad, &shift.elevation_rad}) *value *= flight.given_sigma;
    observation.line.focal_shift = shift;
    tracklet.frames.push_back(frame);
    tracklet.observations.push_back(observation);
    const Eigen::AngleAxisd turn(turns_rad_s * time_s, Vector3d::UnitZ());
    const Vector3d noise(random.Normal(), random.Normal(), random.Normal());
    const Vector3d view = turn * (body * -line.normalized()) + flight.view_noise_rad * noise;
    if (frame % 2 == 0) tracklet.views.push_back({.time_s = time_s, .direction = view.normalized(), .sigma_rad = 0.01});
  }
  return tracklet;
}

std::vector<ObservedTracklet> SeenByAll(const FocalFlight& flight) {
  return {SeenWithFocalLength(1, {0, 0, 0}, flight), SeenWithFocalLength(2, {10, -5, 0}, flight),
          SeenWithFocalLength(3, {-12, 3, 0}, flight), SeenWithFocalLength(4, {5, 8, 0}, flight)};
}

TEST(FocalError, OfAStraightFlightFollowsFromViews) {
  for (const double truth : {-0.2, 0.0, 0.15}) {
    const FocalFlight flight{.log_factor = truth, .given_sigma = 0.2};
    const auto error = EstimateFocalError(SeenByAll(flight));
    ASSERT_TRUE(error);
    EXPECT_NEAR(error->log_factor, truth, 0.06);
    EXPECT_LT(error->sigma_ratio, 0.6);
    EXPECT_EQ(error->objects, 4);
  }
}

TEST(FocalError, IsLimitedByWhatIsKnownBefore) {
  const auto error = EstimateFocalError(SeenByAll({.log_factor = -0.2, .given_sigma = 0.02}));
  ASSERT_TRUE(error);
  EXPECT_LT(std::abs(error->log_factor), 0.03);
  EXPECT_GT(error->sigma_ratio, 0.9);
}

// Noise of the views is no error of the field of view: it would shift all objects of the flight alike.
TEST(FocalError, IsNoneWhereTheViewsDoNotShowOne) {
  int unchanged = 0;
  constexpr int kFlights = 20;
  for (std::int64_t id = 1; id <= kFlights; ++id) {
    const FocalFlight flight{.given_sigma = 0.02};
    const auto error = EstimateFocalError(std::vector{SeenWithFocalLength(id, {0, 0, 0}, flight),
                                                      SeenWithFocalLength(id + 20, {10, -5, 0}, flight),
                                                      SeenWithFocalLength(id + 40, {-12, 3, 0}, flight)});
    ASSERT_TRUE(error);
    unchanged += error->log_factor == 0 ? 1 : 0;
    EXPECT_GT(error->sigma_ratio, 0.9) << "they know no more than the telemetry";
    EXPECT_LE(error->sigma_ratio, 1.05);
  }
  EXPECT_GE(unchanged, kFlights / 2);
}

TEST(FocalError, KnownBetterByTheMotionOfTheImageStaysSo) {
  const auto error = EstimateFocalError(SeenByAll({.log_factor = -0.05, .given_sigma = 0.005}));
  ASSERT_TRUE(error);
  EXPECT_LT(std::abs(error->log_factor), 0.001);
  EXPECT_LT(error->sigma_ratio, 1.01);
}

TEST(FocalError, OneThatTurnsIsAnOutlier) {
  const FocalFlight flight{.log_factor = -0.2, .given_sigma = 0.2};
  std::vector<ObservedTracklet> tracklets = SeenByAll(flight);
  tracklets[1] = SeenWithFocalLength(2, {10, -5, 0}, flight, 0.1);
  const auto error = EstimateFocalError(tracklets);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->log_factor, -0.2, 0.1);
}

TEST(FocalError, NeedsThreeObjectsAndAnError) {
  std::vector<ObservedTracklet> tracklets = SeenByAll({});
  EXPECT_FALSE(EstimateFocalError(std::span(tracklets).first(2)));
  for (ObservedTracklet& tracklet : tracklets) {
    for (BearingObservation& observation : tracklet.observations) observation.line.focal_shift.reset();
  }
  EXPECT_FALSE(EstimateFocalError(tracklets)) << "telemetry has no error of the field of view";
}

TEST(FocalError, CorrectsLinesOfSightAndRanges) {
  std::vector<ObservedTracklet> tracklets = {SeenWithFocalLength(1, {10, 0, 0}, {.log_factor = -0.2})};
  const std::vector<ObservedTracklet> right = {SeenWithFocalLength(1, {10, 0, 0}, {})};
  CorrectFocalLength({.log_factor = -0.2, .sigma_ratio = 0.5, .objects = 3}, tracklets);
  const LineOfSight& corrected = tracklets[0].observations[3].line;
  const LineOfSight& wanted = right[0].observations[3].line;
  EXPECT_NEAR(corrected.azimuth_rad, wanted.azimuth_rad, 1e-9);
  EXPECT_NEAR(corrected.elevation_rad, wanted.elevation_rad, 1e-9);
  EXPECT_NEAR(*corrected.range_m, *wanted.range_m, 1e-6);
  EXPECT_NEAR(corrected.focal_shift->sigma, 0.05, 1e-9);
}

}  // namespace
}  // namespace victorious
