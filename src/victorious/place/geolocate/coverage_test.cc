// Coverage of the covariances: the fraction of flights whose 90 % regions contain the truth.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "testing/chi_squared.h"
#include "testing/drawn_ground.h"
#include "testing/drawn_lines.h"
#include "victorious/base/random.h"
#include "victorious/place/geolocate/locate.h"

namespace victorious {
namespace {

using testing::SimulateLinesOfSight;
using testing::SyntheticGround;
using testing::SyntheticLines;
using testing::SyntheticLinesOptions;

constexpr int kFlights = 200;
constexpr double kChiSquared90Of2 = 4.6051702;

// Circular arcs, near and far, low and high.
SyntheticLinesOptions Flight(int number) {
  Random random(static_cast<std::uint64_t>(number) + 1000);
  SyntheticLinesOptions flight{.seed = static_cast<std::uint64_t>(number) + 1, .count = 200};
  flight.distance_m = random.Uniform(100, 600);
  flight.height_m = random.Uniform(60, 500);
  flight.arc_deg = random.Uniform(30, 360);
  flight.noise_position_m = 2;
  flight.noise_deg = 0.5;
  flight.bias_position_m = 2;
  flight.bias_deg = 0.5;
  return flight;
}

// The same with a moving object.
SyntheticLinesOptions MovingFlight(int number) {
  SyntheticLinesOptions flight = Flight(number);
  flight.arc_deg = std::max(flight.arc_deg, 120.0);
  flight.velocity_enu = {8, -3, 0};
  return flight;
}

struct Coverage {
  double ellipsoid = 0;
  double ellipse = 0;
  double circle = 0;
  double height = 0;
};

// Hills of about 10 m over 300 m; the ground height at the object has an error with the ground's sigma.
std::shared_ptr<const Ground> Hills(int number, const GeodeticPoint& object, double sigma_m) {
  Random random(static_cast<std::uint64_t>(number) + 5000);
  const double given_m = object.altitude_m + sigma_m * random.Normal();
  const double turn = random.Uniform(0, 6);
  const auto wave = [=](double east_m, double north_m) {
    return 10 * std::sin(east_m / 50 + turn) * std::cos(north_m / 70 + turn);
  };
  return std::make_shared<SyntheticGround>(
      object, [=](double east_m, double north_m) { return given_m + wave(east_m, north_m) - wave(0, 0); });
}

struct CoverageCase {
  double outlier_fraction = 0;
  bool one_line = false;
  bool hills = false;
};

void Measure(LocateOptions options, const CoverageCase& test_case) {
  Coverage coverage;
  for (int i = 0; i < kFlights; ++i) {
    SyntheticLinesOptions flight = options.motion == MotionModel::kStatic ? Flight(i) : MovingFlight(i);
    flight.outlier_fraction = test_case.outlier_fraction;
    if (test_case.one_line) flight.count = 1;
    const SyntheticLines drawn = SimulateLinesOfSight(flight);
    if (test_case.hills) options.ground = Hills(i, drawn.object, options.ground_sigma_m);
    const auto fix = Locate(drawn.lines, options);
    EXPECT_TRUE(fix && fix->place) << i;
    if (!fix || !fix->place) continue;
    const Geolocation& place = *fix->place;
    const Eigen::Vector3d off = TangentPlane(place.point).EnuFromGeodetic(drawn.object);
    const Eigen::Vector2d flat = off.head<2>();
    const Eigen::Matrix2d flat_covariance = place.covariance_enu_m2.topLeftCorner<2, 2>();
    constexpr double kOne = 1.0 / kFlights;
    coverage.ellipsoid += off.dot(place.covariance_enu_m2.ldlt().solve(off)) <= testing::kChiSquared90Of3 ? kOne : 0;
    coverage.ellipse += flat.dot(flat_covariance.ldlt().solve(flat)) <= kChiSquared90Of2 ? kOne : 0;
    coverage.circle += flat.norm() <= place.ce90_m ? kOne : 0;
    coverage.height += std::abs(off.z()) <= place.le90_m ? kOne : 0;
  }
  for (const auto& [name, fraction] :
       {std::pair{"ellipsoid", coverage.ellipsoid}, std::pair{"ellipse", coverage.ellipse},
        std::pair{"ce90", coverage.circle}, std::pair{"le90", coverage.height}}) {
    ::testing::Test::RecordProperty(name, std::to_string(fraction));
    EXPECT_GE(fraction, 0.85) << name;
    EXPECT_LE(fraction, 0.95) << name;
  }
}

// On a short arc the ranges determine the distance: given as relative errors, they must not bias it towards the camera.
TEST(Coverage, RangesOnShortArcsAreNotBiased) {
  constexpr int kShortFlights = 100;
  double along_sigmas = 0;
  int inside = 0;
  for (int i = 0; i < kShortFlights; ++i) {
    SyntheticLinesOptions flight = Flight(i);
    flight.count = 60;
    flight.arc_deg = 6;
    SyntheticLines drawn = SimulateLinesOfSight(flight);
    Random random(static_cast<std::uint64_t>(i) + 9000);
    for (LineOfSight& line : drawn.lines) {
      const double distance_m = TangentPlane(line.camera).EnuFromGeodetic(drawn.object).norm();
      line.range_m = distance_m * (1 + LocateOptions{}.line.range_fraction * random.Normal());
    }
    const auto fix = Locate(drawn.lines, {});
    ASSERT_TRUE(fix && fix->place) << i;
    const TangentPlane plane(fix->place->point);
    const Eigen::Vector3d off = plane.EnuFromGeodetic(drawn.object);
    const Eigen::Vector3d along = -plane.EnuFromGeodetic(drawn.lines.front().camera).normalized();
    along_sigmas -= along.dot(off) / std::sqrt(along.dot(fix->place->covariance_enu_m2 * along)) / kShortFlights;
    inside += off.dot(fix->place->covariance_enu_m2.ldlt().solve(off)) <= testing::kChiSquared90Of3 ? 1 : 0;
  }
  EXPECT_NEAR(along_sigmas, 0, 0.3);
  EXPECT_GE(inside, 75);
}

TEST(Coverage, MostLikely) { Measure({.method = LocateMethod::kMaximumLikelihood}, {}); }
TEST(Coverage, MostLikelyWithOutliers) {
  Measure({.method = LocateMethod::kMaximumLikelihood}, {.outlier_fraction = 0.2});
}
TEST(Coverage, MostLikelyMoving) { Measure({.motion = MotionModel::kVelocity}, {}); }
TEST(Coverage, MostLikelyOnHills) { Measure({.method = LocateMethod::kMaximumLikelihood}, {.hills = true}); }
TEST(Coverage, OneLineOnHills) { Measure({.method = LocateMethod::kGround}, {.one_line = true, .hills = true}); }
TEST(Coverage, Ransac) { Measure({.method = LocateMethod::kRansac}, {}); }
TEST(Coverage, LeastSquares) { Measure({.method = LocateMethod::kLeastSquares}, {}); }

}  // namespace
}  // namespace victorious
