// How honest the ellipses are: over many flights, the share whose 90 % ellipsoid holds the truth.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "testing/drawn_lines.h"
#include "victorious/base/random.h"
#include "victorious/geolocate/locate.h"

namespace victorious {
namespace {

using testing::DrawLinesOfSight;
using testing::DrawnLines;
using testing::DrawnLinesOptions;

constexpr int kFlights = 200;
constexpr double kChiSquared90Of3 = 6.2513886;
constexpr double kChiSquared90Of2 = 4.6051702;

// Circles and parts of them, near and far, low and high.
DrawnLinesOptions Flight(int number) {
  Random random(static_cast<std::uint64_t>(number) + 1000);
  DrawnLinesOptions flight{.seed = static_cast<std::uint64_t>(number) + 1, .count = 200};
  flight.distance_m = random.Uniform(100, 600);
  flight.height_m = random.Uniform(60, 500);
  flight.arc_deg = random.Uniform(30, 360);
  flight.noise_position_m = 2;
  flight.noise_deg = 0.5;
  flight.bias_position_m = 2;
  flight.bias_deg = 0.5;
  return flight;
}

// The same of an object that drives past.
DrawnLinesOptions MovingFlight(int number) {
  DrawnLinesOptions flight = Flight(number);
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

void Measure(const LocateOptions& options, double wrong_share) {
  Coverage coverage;
  for (int i = 0; i < kFlights; ++i) {
    DrawnLinesOptions flight = options.motion == "static" ? Flight(i) : MovingFlight(i);
    flight.wrong_share = wrong_share;
    const DrawnLines drawn = DrawLinesOfSight(flight);
    const auto fix = Locate(drawn.lines, options);
    EXPECT_TRUE(fix && fix->place) << i;
    if (!fix || !fix->place) continue;
    const Place& place = *fix->place;
    const Eigen::Vector3d off = TangentPlane(place.point).EnuFromGeodetic(drawn.object);
    const Eigen::Vector2d flat = off.head<2>();
    const Eigen::Matrix2d flat_covariance = place.covariance_enu_m2.topLeftCorner<2, 2>();
    constexpr double kOne = 1.0 / kFlights;
    coverage.ellipsoid += off.dot(place.covariance_enu_m2.ldlt().solve(off)) <= kChiSquared90Of3 ? kOne : 0;
    coverage.ellipse += flat.dot(flat_covariance.ldlt().solve(flat)) <= kChiSquared90Of2 ? kOne : 0;
    coverage.circle += flat.norm() <= place.ce90_m ? kOne : 0;
    coverage.height += std::abs(off.z()) <= place.le90_m ? kOne : 0;
  }
  for (const auto& [name, share] : {std::pair{"ellipsoid", coverage.ellipsoid}, std::pair{"ellipse", coverage.ellipse},
                                    std::pair{"ce90", coverage.circle}, std::pair{"le90", coverage.height}}) {
    ::testing::Test::RecordProperty(name, std::to_string(share));
    EXPECT_GE(share, 0.85) << name;
    EXPECT_LE(share, 0.95) << name;
  }
}

TEST(Coverage, MostLikely) { Measure({.method = "ml"}, 0); }
TEST(Coverage, MostLikelyAmongWrongLines) { Measure({.method = "ml"}, 0.2); }
TEST(Coverage, MostLikelyMoving) { Measure({.motion = "velocity"}, 0); }
TEST(Coverage, Ransac) { Measure({.method = "ransac"}, 0); }
TEST(Coverage, LeastSquares) { Measure({.method = "least-squares"}, 0); }

}  // namespace
}  // namespace victorious
