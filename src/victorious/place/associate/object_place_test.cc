#include "victorious/place/associate/object_place.h"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "testing/chi_squared.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const GeodeticPoint kPlaceOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};
constexpr int kGroups = 12;    // number of recognitions
constexpr int kFollowed = 10;  // frames from one recognition to the next
constexpr int kPlaceFlights = 200;
constexpr double kSigma = 1e-3;  // of a recognised observation's angles, rad; relative, of its range

// No errors except those that a test sets.
ObjectOptions ExactPlace() {
  ObjectOptions options;
  options.locate.motion = MotionModel::kStatic;
  options.locate.line.position_m = 1e-6;
  options.locate.common = {.position_m = 0,
                           .height_m = 0,
                           .heading_deg = 0,
                           .boresight_side_deg = 0,
                           .boresight_rise_deg = 0,
                           .range_fraction = 0};
  return options;
}

// A camera flies past the origin. Tracked observations inherit the error of their recognition.
std::vector<BearingObservation> SimulateFlyby(std::uint64_t seed, double attitude_rad = 0) {
  Random random(seed);
  const auto error = [&](double sigma) { return Vector2d(sigma * random.Normal(), sigma * random.Normal()); };
  const TangentPlane plane(kPlaceOrigin);
  std::vector<BearingObservation> observations;
  for (int group = 0; group < kGroups; ++group) {
    const Vector2d shared = error(kSigma);
    const double range_fraction = kSigma * random.Normal();
    for (int k = 0; k < kFollowed; ++k) {
      const double time_s = 0.1 * static_cast<double>(observations.size());
      const Vector3d camera(-60 + 10 * time_s, -70, 100);
      const Vector2d off = shared + error(attitude_rad);
      BearingObservation observation{.recognition_id = group + 1};
      observation.line = {
          .time_s = time_s,
          .camera = plane.GeodeticFromEnu(camera),
          .azimuth_rad = std::atan2(-camera.x(), -camera.y()) + off.x() / camera.normalized().head<2>().norm(),
          .elevation_rad = std::asin(-camera.z() / camera.norm()) + off.y(),
          .range_m = (1 + range_fraction) * camera.norm(),
          .sigma_rad = kSigma,
          .sigma_range_m = kSigma * camera.norm()};
      if (attitude_rad > 0) observation.sigma_attitude_rad = attitude_rad;
      observations.push_back(observation);
    }
  }
  return observations;
}

// Fraction of flights whose 90 % ellipsoid contains the truth.
template <typename Change>
double Coverage(const Change& change) {
  int inside = 0;
  for (int flight = 0; flight < kPlaceFlights; ++flight) {
    std::vector<BearingObservation> observations = SimulateFlyby(static_cast<std::uint64_t>(flight));
    change(observations);
    const auto place = EstimatePlace(observations, ExactPlace(), 1).place;
    if (!place) continue;
    const Vector3d error = TangentPlane(kPlaceOrigin).EnuFromGeodetic(place->point);
    inside += error.dot(place->covariance_enu_m2.inverse() * error) < testing::kChiSquared90Of3 ? 1 : 0;
  }
  return static_cast<double>(inside) / kPlaceFlights;
}

TEST(ObjectPlace, TrackedObservationsAreCorrelatedWithTheirRecognition) {
  EXPECT_GE(Coverage([](auto&) {}), 0.85);
  const auto on_their_own = [](std::vector<BearingObservation>& observations) {
    for (BearingObservation& observation : observations) observation.recognition_id = 0;
  };
  EXPECT_LT(Coverage(on_their_own), 0.5) << "ten observations with a common error do not average";
}

TEST(ObjectPlace, RangeErrorIsCommonEvenIfFirstObservationHasNoRange) {
  const auto first_without = [](std::vector<BearingObservation>& observations) {
    for (std::size_t i = 0; i < observations.size(); i += kFollowed) observations[i].line.range_m.reset();
  };
  EXPECT_GE(Coverage(first_without), 0.85);
}

TEST(ObjectPlace, TrackedObservationsDoNotReduceCovariance) {
  const std::vector<BearingObservation> all = SimulateFlyby(1);
  std::vector<BearingObservation> recognised;
  for (std::size_t i = 0; i < all.size(); i += kFollowed) recognised.push_back(all[i]);
  const auto with = EstimatePlace(all, ExactPlace(), 1).place;
  const auto without = EstimatePlace(recognised, ExactPlace(), 1).place;
  ASSERT_TRUE(with && without);
  EXPECT_NEAR(with->ce90_m / without->ce90_m, 1, 0.1);
}

TEST(ObjectPlace, TelemetryNoiseAveragesOutOverTrackedObservations) {
  const double attitude_rad = 5 * kSigma;
  std::vector<BearingObservation> all = SimulateFlyby(1, attitude_rad);
  for (BearingObservation& observation : all) observation.line.range_m.reset();
  std::vector<BearingObservation> recognised;
  for (std::size_t i = 0; i < all.size(); i += kFollowed) recognised.push_back(all[i]);
  const auto with = EstimatePlace(all, ExactPlace(), 0).place;
  const auto without = EstimatePlace(recognised, ExactPlace(), 0).place;
  ASSERT_TRUE(with && without);
  EXPECT_LT(with->ce90_m, 0.6 * without->ce90_m);
}

TEST(ObjectPlace, DriftedObservationsHaveLessWeight) {
  // The tracked ones have a common bias, and a standard deviation that covers it.
  const auto drifted = [](std::vector<BearingObservation>& observations) {
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const double drift_rad = kSigma * static_cast<double>(i % kFollowed);
      observations[i].line.elevation_rad += drift_rad;
      observations[i].line.sigma_rad = std::hypot(kSigma, drift_rad);
    }
  };
  EXPECT_GE(Coverage(drifted), 0.8);
}

// Half of a vehicle looks like its other half: where it leaves the image, the pose may be turned and half a length off.
TEST(ObjectPlace, ReversedHeadingsDoNotPlace) {
  std::vector<BearingObservation> observations = SimulateFlyby(3);
  for (BearingObservation& observation : observations) observation.heading_rad = 1;
  const ObjectPlace right = EstimatePlace(observations, ExactPlace(), 1);
  for (BearingObservation& last : std::span(observations).last(8)) {
    last.heading_rad = 1 + kPi;
    last.line.azimuth_rad += 0.05;
    *last.line.range_m += 3;
  }
  const ObjectPlace place = EstimatePlace(observations, ExactPlace(), 1);
  ASSERT_TRUE(place.place);
  EXPECT_LT(TangentPlane(right.place->point).EnuFromGeodetic(place.place->point).norm(), 0.5);
  EXPECT_NEAR(*place.heading_rad, 1, 1e-6);
  EXPECT_EQ(place.contradicting_headings, 8);
  EXPECT_EQ(place.headings, static_cast<std::int64_t>(observations.size()));
  EXPECT_LT(place.inlier_fraction, 1);
}

TEST(ObjectPlace, ResidualCombinesLineAndRange) {
  BearingObservation observation = SimulateFlyby(1, 0).front();
  LocateOptions errors;
  errors.line.position_m = 0;
  errors.common = {.position_m = 0, .height_m = 0, .heading_deg = 0, .boresight_rise_deg = 0, .range_fraction = 0};
  observation.line.range_m = 100;
  observation.line.sigma_range_m = 4;
  observation.line.sigma_rad = 0.01;
  const TangentPlane plane(observation.line.camera);
  const double cos_elevation = std::cos(observation.line.elevation_rad);
  const Eigen::Vector3d along(std::sin(observation.line.azimuth_rad) * cos_elevation,
                              std::cos(observation.line.azimuth_rad) * cos_elevation,
                              std::sin(observation.line.elevation_rad));
  const auto at = [&](const Eigen::Vector3d& enu) {
    return Geolocation{.point = plane.GeodeticFromEnu(enu), .covariance_enu_m2 = 1e-8 * Eigen::Matrix3d::Identity()};
  };
  EXPECT_NEAR(MahalanobisDistance(observation, at(100 * along), 0, errors, 1), 0, 0.01);
  EXPECT_NEAR(MahalanobisDistance(observation, at(108 * along), 0, errors, 1), 2, 0.01);
  EXPECT_NEAR(MahalanobisDistance(observation, at(108 * along), 3, errors, 1), 8 / 5.0, 0.01) << "4 and 3 m";
  const Eigen::Vector3d beside = 100 * along + 3 * along.unitOrthogonal();
  EXPECT_NEAR(MahalanobisDistance(observation, at(beside), 0, errors, 1), 3, 0.02);
  observation.line.range_m.reset();
  EXPECT_NEAR(MahalanobisDistance(observation, at(108 * along), 0, errors, 1), 0, 0.01)
      << "without a range only the direction counts";
  EXPECT_EQ(MahalanobisDistance(observation, at(-100 * along), 0, errors, 1), std::numeric_limits<double>::infinity());
}

TEST(ObjectPlace, PropagatedPlaceHasLargerCovariance) {
  const TangentPlane plane({0.8, 0.2, 500});
  Geolocation place{.point = plane.GeodeticFromEnu({0, 0, 0}),
                    .time_s = 2,
                    .covariance_enu_m2 = Eigen::Matrix3d::Identity(),
                    .velocity_enu = Eigen::Vector3d(3, -4, 0),
                    .velocity_covariance_enu = 0.25 * Eigen::Matrix3d::Identity(),
                    .ce90_m = 2.15};
  const Geolocation then = PropagatePlace(place, 4);
  EXPECT_LT((plane.EnuFromGeodetic(then.point) - Eigen::Vector3d(6, -8, 0)).norm(), 1e-3);
  EXPECT_NEAR(then.covariance_enu_m2(0, 0), 2, 1e-9);
  EXPECT_GT(then.ce90_m, 1.3 * place.ce90_m);
  place.velocity_enu = Eigen::Vector3d::Zero();
  EXPECT_EQ(PropagatePlace(place, 4).covariance_enu_m2, place.covariance_enu_m2) << "a static object keeps its place";
}

TEST(EstimateHeadingMode, IsTheCentreOfTheDensest40DegreesAlsoAcrossNorth) {
  std::vector<double> headings;
  for (const double degrees : {350.0, 355.0, 0.0, 5.0, 10.0, 90.0, 91.0, 180.0}) {
    headings.push_back(RadiansFromDegrees(degrees));
  }
  const std::optional<double> heading = EstimateHeadingMode(headings);
  ASSERT_TRUE(heading);
  EXPECT_NEAR(WrapAngle(*heading), 0, 1e-9);
  EXPECT_FALSE(EstimateHeadingMode({}));
}

}  // namespace
}  // namespace victorious
