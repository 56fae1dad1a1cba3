#include "victorious/place/geolocate/locate.h"

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_ground.h"
#include "testing/drawn_lines.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using testing::SimulateLinesOfSight;
using testing::SyntheticGround;
using testing::SyntheticLines;

GeoFix LocateOrFail(const std::vector<LineOfSight>& lines, const LocateOptions& options) {
  auto fix = Locate(lines, options);
  EXPECT_TRUE(fix) << fix.error().message;
  return fix ? *std::move(fix) : GeoFix{};
}

double PlaceError(const GeoFix& fix, const GeodeticPoint& truth) {
  return fix.place ? TangentPlane(truth).EnuFromGeodetic(fix.place->point).norm() : HUGE_VAL;
}

std::ptrdiff_t Inliers(const GeoFix& fix) { return std::ranges::count(fix.inliers, true); }

std::string_view Text(LocateMethod method) { return ToText(kLocateMethodTexts, method); }

class EachMethod : public ::testing::TestWithParam<LocateMethod> {
 protected:
  LocateOptions options{.method = GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Methods, EachMethod,
                         ::testing::Values(LocateMethod::kLeastSquares, LocateMethod::kPrior, LocateMethod::kRansac,
                                           LocateMethod::kMaximumLikelihood),
                         [](const auto& one) {
                           std::string name(Text(one.param));
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST_P(EachMethod, RecoversExactPlace) {
  const SyntheticLines drawn = SimulateLinesOfSight({});
  const GeoFix fix = LocateOrFail(drawn.lines, options);
  EXPECT_EQ(StatusText(fix), "ok");
  EXPECT_LT(PlaceError(fix, drawn.object), 1e-4);
  EXPECT_EQ(Inliers(fix), 100);
  EXPECT_FALSE(fix.place->velocity_enu);
}

TEST_P(EachMethod, LocatesMovingObjectAtTheTimeOfTheLastLine) {
  options.motion = MotionModel::kVelocity;
  const SyntheticLines drawn = SimulateLinesOfSight({.velocity_enu = {3, -2, 0.1}});
  const GeoFix fix = LocateOrFail(drawn.lines, options);
  EXPECT_EQ(StatusText(fix), "ok");
  EXPECT_LT(PlaceError(fix, drawn.object), 1e-3);
  EXPECT_DOUBLE_EQ(fix.place->time_s, 60);
  EXPECT_LT((*fix.place->velocity_enu - Eigen::Vector3d(3, -2, 0.1)).norm(), 1e-4);
}

TEST_P(EachMethod, OneLineWithRangeGivesPlace) {
  const SyntheticLines drawn = SimulateLinesOfSight({.count = 1, .range_fraction = 1e-6});
  const GeoFix fix = LocateOrFail(drawn.lines, options);
  EXPECT_EQ(StatusText(fix), "ok");
  EXPECT_LT(PlaceError(fix, drawn.object), 0.01);
}

TEST_P(EachMethod, OneLineWithoutRangeIsRefused) {
  const GeoFix fix = LocateOrFail(SimulateLinesOfSight({.count = 1}).lines, options);
  EXPECT_FALSE(fix.place);
  EXPECT_EQ(StatusText(fix), "undetermined: a single line of sight needs a range");
  EXPECT_EQ(Inliers(fix), 0);
}

TEST_P(EachMethod, ParallelLinesGiveNoPlace) {
  std::vector<LineOfSight> lines = SimulateLinesOfSight({.count = 5}).lines;
  for (LineOfSight& line : lines) line.camera = lines[0].camera;
  for (LineOfSight& line : lines) line.azimuth_rad = lines[0].azimuth_rad, line.elevation_rad = lines[0].elevation_rad;
  const GeoFix fix = LocateOrFail(lines, options);
  EXPECT_FALSE(fix.place);
  EXPECT_THAT(StatusText(fix), HasSubstr("parallel"));
}

TEST_P(EachMethod, IntersectionBehindTheCameraIsReported) {
  std::vector<LineOfSight> lines = SimulateLinesOfSight({.count = 2}).lines;
  for (LineOfSight& line : lines) line.azimuth_rad += kPi, line.elevation_rad *= -1;
  const GeoFix fix = LocateOrFail(lines, options);
  EXPECT_FALSE(fix.place);
  EXPECT_THAT(StatusText(fix), HasSubstr("behind the camera"));
}

TEST_P(EachMethod, UnobservableRangeGivesNoPlace) {
  // A baseline of 1 m at 360 m: the offsets are only noise.
  const GeoFix fix =
      LocateOrFail(SimulateLinesOfSight({.arc_deg = 0.2, .noise_position_m = 1, .noise_deg = 0.1}).lines, options);
  EXPECT_FALSE(fix.place);
  EXPECT_THAT(StatusText(fix), HasSubstr("undetermined: "));
}

TEST_P(EachMethod, StaticCameraGivesNoRangeForAnyNumberOfLines) {
  for (const int count : {5, 100, 4000}) {
    for (const double noise_m : {0.0, 2.0}) {
      if (options.method == LocateMethod::kPrior && count > 100) continue;  // quadratic
      const GeoFix fix = LocateOrFail(
          SimulateLinesOfSight({.count = count, .arc_deg = 0, .noise_position_m = noise_m, .noise_deg = 0.5}).lines,
          options);
      EXPECT_TRUE(!fix.place || fix.place->ce90_m > 100) << count << " " << noise_m << " " << fix.place->ce90_m;
    }
  }
}

TEST(Locate, StaticCameraOnGroundKeepsItsEllipse) {
  for (const LocateMethod method : {LocateMethod::kGround, LocateMethod::kMaximumLikelihood}) {
    LocateOptions options{.method = method};
    options.ground = std::make_shared<FlatGround>(5);
    std::vector<double> ce90_m;
    for (const int count : {20, 4000}) {
      const SyntheticLines drawn =
          SimulateLinesOfSight({.count = count, .arc_deg = 0, .noise_position_m = 2, .noise_deg = 0.5});
      const GeoFix fix = LocateOrFail(drawn.lines, options);
      ASSERT_TRUE(fix.place) << Text(method) << StatusText(fix);
      EXPECT_LT(PlaceError(fix, drawn.object), 5) << Text(method);
      ce90_m.push_back(fix.place->ce90_m);
    }
    EXPECT_GT(ce90_m[1], 0.85 * ce90_m[0]) << Text(method);
  }
}

TEST_P(EachMethod, TwoLinesGiveNoVelocity) {
  options.motion = MotionModel::kVelocity;
  const GeoFix fix = LocateOrFail(SimulateLinesOfSight({.count = 2}).lines, options);
  EXPECT_FALSE(fix.place);
  EXPECT_THAT(StatusText(fix), HasSubstr("velocity"));
}

TEST_P(EachMethod, EllipseOfManyLinesExceedsCommonErrors) {
  const testing::SyntheticLinesOptions flight{.arc_deg = 90, .noise_position_m = 1, .noise_deg = 0.2};
  testing::SyntheticLinesOptions longer = flight;
  longer.count = 4000;
  options.common.position_m = 3;
  const GeoFix few = LocateOrFail(SimulateLinesOfSight(flight).lines, options);
  const GeoFix many = LocateOrFail(SimulateLinesOfSight(longer).lines, options);
  ASSERT_TRUE(few.place && many.place) << StatusText(few) << StatusText(many);
  EXPECT_GT(many.place->ce90_m, 3 * 2.146 * 0.99);  // CE90 of 3 m along each axis alone
  EXPECT_GT(many.place->ce90_m, 0.8 * few.place->ce90_m);
}

// The errors of a stationary camera repeat in every frame: the part of the lines' own errors that does not show in
// their scatter is common to all of them.
TEST(Locate, RepeatedLineAddsNoInformation) {
  const SyntheticLines drawn = SimulateLinesOfSight({.count = 1});
  const std::vector<LineOfSight> many(50, drawn.lines.front());
  for (const LocateMethod method :
       {LocateMethod::kGround, LocateMethod::kPrior, LocateMethod::kRansac, LocateMethod::kMaximumLikelihood}) {
    LocateOptions options{.method = method};
    options.ground = std::make_shared<FlatGround>(drawn.object.altitude_m);
    const GeoFix once = LocateOrFail(drawn.lines, options);
    const GeoFix again = LocateOrFail(many, options);
    ASSERT_TRUE(once.place && again.place) << Text(method);
    EXPECT_LT(PlaceError(again, drawn.object), 0.02) << Text(method);
    EXPECT_GE(again.place->ce90_m, 0.999 * once.place->ce90_m) << Text(method);
    EXPECT_LE(again.place->ce90_m, 1.1 * once.place->ce90_m) << Text(method);
  }
}

TEST(Locate, RejectsOutlierLines) {
  const SyntheticLines drawn =
      SimulateLinesOfSight({.outlier_fraction = 0.3, .noise_position_m = 0.5, .noise_deg = 0.1});
  for (const LocateMethod method : {LocateMethod::kRansac, LocateMethod::kMaximumLikelihood}) {
    const GeoFix fix = LocateOrFail(drawn.lines, {.method = method});
    EXPECT_LT(PlaceError(fix, drawn.object), 2) << Text(method);
    for (std::size_t i = 0; i < drawn.wrong.size(); ++i)
      EXPECT_TRUE(fix.inliers[i] || drawn.wrong[i]) << Text(method) << i;
  }
  const GeoFix all = LocateOrFail(drawn.lines, {.method = LocateMethod::kLeastSquares});
  EXPECT_GT(PlaceError(all, drawn.object), 2);  // least squares is not robust
}

TEST(Locate, PriorRejectsLinesWithPlaceOutsideTheirFrustum) {
  SyntheticLines drawn = SimulateLinesOfSight({.noise_deg = 0.05, .range_fraction = 0.05});
  drawn.lines[50].azimuth_rad += RadiansFromDegrees(20);
  drawn.lines[70].range_m = *drawn.lines[70].range_m * 3;
  const GeoFix fix = LocateOrFail(drawn.lines, {.method = LocateMethod::kPrior});
  EXPECT_LT(PlaceError(fix, drawn.object), 1);
  EXPECT_EQ(Inliers(fix), 98);
  EXPECT_FALSE(fix.inliers[50]);
  EXPECT_FALSE(fix.inliers[70]);
}

TEST(Locate, RangesCompensateForAShortBaseline) {
  const testing::SyntheticLinesOptions flight{.arc_deg = 0.5, .noise_deg = 0.1, .range_fraction = 0.05};
  const SyntheticLines drawn = SimulateLinesOfSight(flight);
  for (const LocateMethod method : {LocateMethod::kPrior, LocateMethod::kRansac, LocateMethod::kMaximumLikelihood}) {
    EXPECT_LT(PlaceError(LocateOrFail(drawn.lines, {.method = method}), drawn.object), 10) << Text(method);
  }
}

TEST(Locate, FlatGroundLocatesOneLine) {
  const SyntheticLines drawn = SimulateLinesOfSight({.count = 1});
  for (const LocateMethod method : {LocateMethod::kGround, LocateMethod::kPrior, LocateMethod::kMaximumLikelihood}) {
    LocateOptions options{.method = method};
    options.ground = std::make_shared<FlatGround>(drawn.object.altitude_m);
    const GeoFix fix = LocateOrFail(drawn.lines, options);
    EXPECT_LT(PlaceError(fix, drawn.object), 0.02) << Text(method);
    ASSERT_TRUE(fix.place) << Text(method);
    // The error ellipsoid is flat along the ground: the height is known as well as the ground's.
    EXPECT_NEAR(fix.place->le90_m, options.ground_sigma_m * 1.645, 0.1) << Text(method);
    EXPECT_GT(fix.place->ce90_m, 5) << Text(method);
  }
}

// A hillside that rises by one in two to the north, observed from the south.
TEST(Locate, TerrainLocatesOneLine) {
  const testing::SyntheticLinesOptions flight{.count = 1};
  const SyntheticLines drawn = SimulateLinesOfSight(flight);
  const double height_m = drawn.object.altitude_m;
  LocateOptions options{.method = LocateMethod::kMaximumLikelihood};
  options.ground =
      std::make_shared<SyntheticGround>(drawn.object, [=](double, double north_m) { return height_m + 0.5 * north_m; });
  for (const LocateMethod method : {LocateMethod::kGround, LocateMethod::kPrior, LocateMethod::kMaximumLikelihood}) {
    options.method = method;
    const GeoFix fix = LocateOrFail(drawn.lines, options);
    EXPECT_LT(PlaceError(fix, drawn.object), 0.02) << Text(method) << ": " << StatusText(fix);
    ASSERT_TRUE(fix.place);
    // The error along the ground follows the slope.
    const Eigen::Vector3d across = Eigen::Vector3d(0, -0.5, 1).normalized();
    const double across_sigma_m = std::sqrt(across.dot(fix.place->covariance_enu_m2 * across));
    EXPECT_NEAR(across_sigma_m, options.ground_sigma_m * across.z(), 0.05) << Text(method);
  }
}

TEST(Locate, ReportsWhyALineMissesTheTerrain) {
  const SyntheticLines drawn = SimulateLinesOfSight({.count = 1});
  const auto status_on = [&](const std::function<double(double, double)>& height) {
    LocateOptions options{.method = LocateMethod::kGround};
    options.ground = std::make_shared<SyntheticGround>(drawn.object, height);
    const GeoFix fix = LocateOrFail(drawn.lines, options);
    EXPECT_FALSE(fix.place);
    return StatusText(fix);
  };
  EXPECT_THAT(status_on([](double, double) { return 9999.0; }), HasSubstr("below the ground"));
  EXPECT_THAT(status_on([](double, double) { return std::nan(""); }), HasSubstr("leaves the terrain"));
}

TEST(Locate, TerrainIsAPriorForManyLinesOnASlope) {
  const SyntheticLines drawn = SimulateLinesOfSight({.noise_position_m = 2, .noise_deg = 0.5});
  const double height_m = drawn.object.altitude_m;
  LocateOptions options;
  const GeoFix without = LocateOrFail(drawn.lines, options);
  options.ground = std::make_shared<SyntheticGround>(
      drawn.object, [=](double east_m, double north_m) { return height_m + 0.4 * east_m - 0.3 * north_m; });
  options.ground_sigma_m = 0.2;
  const GeoFix with = LocateOrFail(drawn.lines, options);
  ASSERT_TRUE(without.place && with.place);
  const Eigen::Vector3d across = Eigen::Vector3d(-0.4, 0.3, 1).normalized();
  EXPECT_LT(across.dot(with.place->covariance_enu_m2 * across), 0.05);
  EXPECT_LT(std::abs(across.dot(TangentPlane(drawn.object).EnuFromGeodetic(with.place->point))), 0.5);
  EXPECT_LT(with.place->ce90_m, without.place->ce90_m);
}

TEST(Locate, FlyingObjectIsNotPulledToTheGround) {
  const SyntheticLines drawn = SimulateLinesOfSight({.noise_position_m = 0.1, .noise_deg = 0.1});
  LocateOptions options;
  const GeoFix without = LocateOrFail(drawn.lines, options);
  options.ground = std::make_shared<FlatGround>(drawn.object.altitude_m - 60);
  const GeoFix with = LocateOrFail(drawn.lines, options);
  ASSERT_TRUE(without.place && with.place);
  EXPECT_NEAR(PlaceError(with, drawn.object), PlaceError(without, drawn.object), 1e-3);
}

// Ranges with a relative error of 20 %, and a ground known to 0.5 m.
TEST(Locate, GroundImprovesPlacesFromRange) {
  const SyntheticLines drawn = SimulateLinesOfSight({.seed = 5, .count = 5, .arc_deg = 0, .range_fraction = 0.2});
  LocateOptions options;
  options.line.range_fraction = 0.2;
  options.common.range_fraction = 0.1;
  const GeoFix by_range = LocateOrFail(drawn.lines, options);
  options.ground = std::make_shared<FlatGround>(drawn.object.altitude_m);
  options.ground_sigma_m = 0.5;
  const GeoFix on_ground = LocateOrFail(drawn.lines, options);
  ASSERT_TRUE(by_range.place && on_ground.place);
  EXPECT_LT(PlaceError(on_ground, drawn.object), 0.2 * PlaceError(by_range, drawn.object));
  EXPECT_LT(on_ground.place->le90_m, 0.2 * by_range.place->le90_m);
  EXPECT_LT(on_ground.place->ce90_m, by_range.place->ce90_m);
  // Far above the ground the object is not on it.
  options.ground = std::make_shared<FlatGround>(drawn.object.altitude_m - 190);
  EXPECT_NEAR(PlaceError(LocateOrFail(drawn.lines, options), drawn.object), PlaceError(by_range, drawn.object), 1e-6);
}

TEST(Locate, GroundIsAPriorForManyLines) {
  const SyntheticLines drawn = SimulateLinesOfSight({.noise_position_m = 2, .noise_deg = 0.5});
  LocateOptions options;
  const GeoFix without = LocateOrFail(drawn.lines, options);
  options.ground = std::make_shared<FlatGround>(drawn.object.altitude_m);
  options.ground_sigma_m = 0.5;
  const GeoFix with = LocateOrFail(drawn.lines, options);
  ASSERT_TRUE(without.place && with.place);
  EXPECT_LT(with.place->le90_m, 0.5 * without.place->le90_m);
}

TEST(Locate, EllipseGrowsWithExcessResiduals) {
  const SyntheticLines drawn = SimulateLinesOfSight({.count = 30, .noise_position_m = 0.1, .noise_deg = 1});
  std::vector<LineOfSight> overconfident = drawn.lines;
  for (LineOfSight& line : overconfident) line.sigma_rad = RadiansFromDegrees(0.4);
  LocateOptions options{.identity_radius_m = 20};
  options.line.position_m = 0.1;
  options.common = {0.01, 0.01, 0.01, 0.01, 0.01, 0.01};
  const GeoFix honest = LocateOrFail(drawn.lines, options);
  const GeoFix from_overconfident = LocateOrFail(overconfident, options);
  ASSERT_TRUE(honest.place && from_overconfident.place);
  EXPECT_GT(from_overconfident.place->ce90_m, 0.7 * honest.place->ce90_m);
}

TEST(Locate, RefusesInvalidLines) {
  EXPECT_FALSE(Locate({}, {}));
  const SyntheticLines drawn = SimulateLinesOfSight({.count = 2});
  EXPECT_FALSE(Locate(drawn.lines, {.method = LocateMethod::kGround}));
  EXPECT_FALSE(Locate(drawn.lines, {.distance_prior_allowance = 0.5}));
}

// What each parameter changes.

TEST(LocateParameter, IdentityRadiusIsTheDistanceFromTheLineThatAnInlierMayHave) {
  SyntheticLines drawn = SimulateLinesOfSight({});
  drawn.lines[50].azimuth_rad += 8 / 300.0;  // passes the object at 8 m
  LocateOptions options;
  options.line = {.position_m = 0.1, .angle_deg = 0.01};
  options.common = {0.01, 0.01, 0.01, 0.01, 0.01, 0.01};
  options.identity_radius_m = 2;
  EXPECT_FALSE(LocateOrFail(drawn.lines, options).inliers[50]);
  options.identity_radius_m = 12;
  EXPECT_TRUE(LocateOrFail(drawn.lines, options).inliers[50]);
}

TEST(LocateParameter, DistancePriorAllowanceIsTheFactorThatARangeMayBeOffBy) {
  SyntheticLines drawn = SimulateLinesOfSight({.noise_deg = 0.05, .range_fraction = 0.01});
  drawn.lines[70].range_m = *drawn.lines[70].range_m * 1.8;
  LocateOptions options{.method = LocateMethod::kPrior};
  options.line.range_fraction = 0.01;
  options.common.range_fraction = 0;
  options.distance_prior_allowance = 1.5;
  EXPECT_FALSE(LocateOrFail(drawn.lines, options).inliers[70]);
  options.distance_prior_allowance = 2;
  EXPECT_TRUE(LocateOrFail(drawn.lines, options).inliers[70]);
}

// One line is four sigmas off.
TEST(LocateParameter, GateIsTheResidualInSigmasThatAnInlierMayHave) {
  SyntheticLines drawn = SimulateLinesOfSight({});
  drawn.lines[50].elevation_rad += RadiansFromDegrees(4);
  LocateOptions options{.identity_radius_m = 0.01};
  options.line = {.position_m = 1e-3, .angle_deg = 1};
  options.gate_sigma = 3;
  EXPECT_FALSE(LocateOrFail(drawn.lines, options).inliers[50]);
  options.gate_sigma = 5;
  EXPECT_TRUE(LocateOrFail(drawn.lines, options).inliers[50]);
}

// A third of the lines is four sigmas too high, within the gate: the lower Huber's threshold, the less they weigh.
TEST(LocateParameter, RobustSigmaBoundsTheWeightOfLargeResiduals) {
  SyntheticLines drawn = SimulateLinesOfSight({});
  for (std::size_t i = 0; i < drawn.lines.size(); i += 3) drawn.lines[i].elevation_rad += RadiansFromDegrees(4);
  LocateOptions options{.gate_sigma = 20};
  options.line = {.position_m = 1e-3, .angle_deg = 1};
  options.robust_sigma = 20;
  const double least_squares_m = PlaceError(LocateOrFail(drawn.lines, options), drawn.object);
  options.robust_sigma = 0.5;
  EXPECT_LT(PlaceError(LocateOrFail(drawn.lines, options), drawn.object), 0.5 * least_squares_m);
}

// A single line that meets the ground under the angle of elevation: what it is off by shows in its place.
class GroundedLine : public ::testing::Test {
 protected:
  GroundedLine() {
    options_.ground = std::make_shared<FlatGround>(drawn_.object.altitude_m);
    options_.line = {.position_m = 1e-3, .angle_deg = 1e-3};
    options_.common = {0, 0, 0, 0, 0, 0};
    options_.ground_sigma_m = 1e-3;
  }
  Geolocation Place() { return LocateOrFail(drawn_.lines, options_).place.value(); }

  static constexpr double kDistance_m = 300;  // horizontal
  static constexpr double kHeight_m = 200;
  static constexpr double kLe90Sigmas = 1.645;
  SyntheticLines drawn_ = SimulateLinesOfSight({.count = 1, .distance_m = kDistance_m, .height_m = kHeight_m});
  LocateOptions options_{.method = LocateMethod::kGround};
};

TEST_F(GroundedLine, GroundSigmaIsTheSigmaOfTheHeight) {
  options_.ground_sigma_m = 4;
  EXPECT_NEAR(Place().le90_m, 4 * kLe90Sigmas, 0.1);
}

TEST_F(GroundedLine, AngleIsTheSigmaOfALineThatGivesNone) {
  options_.line.angle_deg = 1;
  const double narrow_m = Place().ce90_m;
  EXPECT_GT(narrow_m, kLe90Sigmas * kDistance_m * RadiansFromDegrees(1)) << "across and along the line";
  options_.line.angle_deg = 2;
  EXPECT_NEAR(Place().ce90_m / narrow_m, 2, 0.01);
  drawn_.lines[0].sigma_rad = RadiansFromDegrees(1);
  EXPECT_NEAR(Place().ce90_m / narrow_m, 1, 0.01) << "the line's own sigma takes precedence";
}

TEST_F(GroundedLine, CommonErrorsAreThoseOfThePlace) {
  options_.common.position_m = 3;
  constexpr double kCe90Sigmas = 2.146;  // of a circular normal distribution
  EXPECT_NEAR(Place().ce90_m, 3 * kCe90Sigmas, 0.1);
  options_.common.position_m = 0;
  options_.common.height_m = 4;  // moves the intersection with the ground along the line's azimuth
  EXPECT_NEAR(Place().ce90_m, kLe90Sigmas * 4 * kDistance_m / kHeight_m, 0.2);
  options_.common.height_m = 0;
  options_.common.heading_deg = 1;  // moves it across
  EXPECT_NEAR(Place().ce90_m, kLe90Sigmas * kDistance_m * RadiansFromDegrees(1), 0.2);
}

}  // namespace
}  // namespace victorious
