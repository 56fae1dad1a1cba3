#include "victorious/place/geolocate/motion_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/ground.h"
#include "victorious/place/geolocate/linear_place.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const GeodeticPoint kOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};
constexpr double kCentreHeight_m = 1.2;

enum class CameraMotionKind { kStraight, kCircling, kHovering };
enum class Drive { kParked, kStraight, kCorner, kFromRest, kStop };

constexpr std::array kPathFlights = {CameraMotionKind::kStraight, CameraMotionKind::kCircling,
                                     CameraMotionKind::kHovering};
constexpr std::array kDrives = {Drive::kStraight, Drive::kCorner, Drive::kFromRest, Drive::kStop};

struct Case {
  CameraMotionKind flight = CameraMotionKind::kStraight;
  Drive drive = Drive::kStraight;
  std::uint64_t seed = 1;
  double range_factor = 1;   ///< of the given ranges
  double flight_errors = 1;  ///< factor of the errors that the options say are common to a flight
  double gap_from_s = 0;     ///< no lines from here
  double gap_to_s = 0;       ///< to here
  int outliers = 0;          ///< every so many lines has a wrong direction; 0: none
};

constexpr double kDuration_s = 8;
constexpr int kCount = 41;

Vector3d CameraAt(CameraMotionKind flight, double time_s) {
  if (flight == CameraMotionKind::kStraight) return {-40 + 10 * time_s, -75, 101};
  const double angle_rad =
      flight == CameraMotionKind::kCircling ? RadiansFromDegrees(200 + 11 * time_s) : RadiansFromDegrees(200);
  return {75 * std::sin(angle_rad), 75 * std::cos(angle_rad), 101};
}

// Turns within 1.2 s; starts and stops at 3 m/s^2.
Vector2d DrivenAt(Drive drive, double speed_m_s, double time_s) {
  const double half_s = kDuration_s / 2;
  const Vector2d start(-10, 5);
  if (drive == Drive::kParked) return start;
  if (drive == Drive::kStraight) return start + time_s * speed_m_s * Vector2d(0.8, 0.6);
  if (drive == Drive::kCorner) {
    constexpr double kTurn_s = 1.2;
    const double turning = std::clamp((time_s - half_s) / kTurn_s, 0.0, 1.0);
    const double radius_m = speed_m_s * kTurn_s / (kPi / 2);
    const double angle = turning * kPi / 2;
    return start + Vector2d(speed_m_s * std::min(time_s, half_s) + radius_m * std::sin(angle),
                            -radius_m * (1 - std::cos(angle)) - speed_m_s * std::max(0.0, time_s - half_s - kTurn_s));
  }
  constexpr double kAcceleration_m_s2 = 3;
  const double change_s = speed_m_s / kAcceleration_m_s2;
  const auto from_rest = [&](double for_s) {
    if (for_s <= 0) return 0.0;
    return for_s < change_s ? kAcceleration_m_s2 * for_s * for_s / 2 : speed_m_s * (for_s - change_s / 2);
  };
  const double driven_m = drive == Drive::kFromRest ? from_rest(time_s - 2) : -from_rest(kDuration_s - 2 - time_s);
  return start + driven_m * Vector2d(0.6, 0.8);
}

double SpeedOf(std::uint64_t seed) { return 4 + static_cast<double>(seed % 6); }

Vector3d ObjectAt(const Case& drawn, double time_s) {
  const Vector2d at = DrivenAt(drawn.drive, SpeedOf(drawn.seed), time_s);
  return {at.x(), at.y(), kCentreHeight_m};
}

Vector2d VelocityAt(const Case& drawn, double time_s) {
  constexpr double kStep_s = 1e-4;
  return (ObjectAt(drawn, time_s + kStep_s) - ObjectAt(drawn, time_s - kStep_s)).head<2>() / (2 * kStep_s);
}

LocateOptions PathOptions() {
  LocateOptions options;
  options.motion = MotionModel::kAuto;
  options.line.position_m = 0.1;
  return options;
}

// Lines with errors of the sigmas that are given with them, and errors common to the flight.
std::vector<LineOfSight> DrawLines(const Case& drawn) {
  constexpr double kSigma_rad = 2e-4;
  constexpr double kRangeFraction = 0.015;
  Random random(drawn.seed + 100 * static_cast<std::uint64_t>(drawn.drive) +
                1000 * static_cast<std::uint64_t>(drawn.flight));
  const LocateOptions options = PathOptions();
  const auto sigmas = CommonErrorSigmas(options.common);
  std::array<double, kNumCommonErrors> common{};
  for (int k = 0; k < kNumCommonErrors; ++k) {
    common.at(static_cast<std::size_t>(k)) = drawn.flight_errors * sigmas[k] * random.Normal();
  }
  const TangentPlane plane(kOrigin);
  std::vector<LineOfSight> lines;
  for (int i = 0; i < kCount; ++i) {
    const double time_s = kDuration_s * i / (kCount - 1);
    const Vector3d camera = CameraAt(drawn.flight, time_s);
    const Vector3d line = ObjectAt(drawn, time_s) - camera;
    const Vector3d jitter = options.line.position_m * Vector3d(random.Normal(), random.Normal(), random.Normal());
    const Vector2d noise(kSigma_rad * random.Normal(), kSigma_rad * random.Normal());
    const double range_noise = kRangeFraction * random.Normal();
    if (time_s > drawn.gap_from_s && time_s < drawn.gap_to_s) continue;
    const double wrong_rad = drawn.outliers > 0 && i % drawn.outliers == 1 ? 0.02 : 0;
    const double elevation = std::asin(line.z() / line.norm());
    const double side_rad = noise.x() - common[4] + wrong_rad;
    lines.push_back({.time_s = time_s,
                     .camera = plane.GeodeticFromEnu(camera + jitter - Vector3d(common[0], common[1], common[2])),
                     .azimuth_rad = std::atan2(line.x(), line.y()) - common[3] + side_rad / std::cos(elevation),
                     .elevation_rad = elevation + noise.y() - common[5],
                     .range_m = line.norm() * (1 - common[6] + range_noise) * drawn.range_factor,
                     .sigma_rad = kSigma_rad,
                     .sigma_range_m = kRangeFraction * line.norm()});
  }
  return lines;
}

Vector3d ErrorOf(const Geolocation& place, const Case& drawn) {
  return TangentPlane(kOrigin).EnuFromGeodetic(place.point) - ObjectAt(drawn, place.time_s);
}

std::string Name(const Case& drawn) {
  return "flight " + std::to_string(static_cast<int>(drawn.flight)) + ", drive " +
         std::to_string(static_cast<int>(drawn.drive)) + ", seed " + std::to_string(drawn.seed);
}

template <typename Visit>
void VisitCases(std::uint64_t seeds, double flight_errors, const Visit& visit) {
  for (const CameraMotionKind flight : kPathFlights) {
    for (const Drive drive : kDrives) {
      for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        visit(Case{.flight = flight, .drive = drive, .seed = seed, .flight_errors = flight_errors});
      }
    }
  }
}

TEST(MotionPath, FollowsDrivingObjectsWithExactTelemetry) {
  int checked = 0;
  VisitCases(3, 0, [&](const Case& drawn) {
    const auto path = EstimatePath(DrawLines(drawn), PathOptions());
    ASSERT_TRUE(path) << Name(drawn);
    ASSERT_TRUE(path->is_moving) << Name(drawn);
    ASSERT_EQ(path->places.size(), static_cast<std::size_t>(kCount));
    double squares = 0;
    for (const Geolocation& place : path->places) squares += ErrorOf(place, drawn).head<2>().squaredNorm() / kCount;
    EXPECT_LT(std::sqrt(squares), 1.0) << Name(drawn) << ": the mean of 41 ranges is good to 0.3 m";
    const Geolocation& last = path->places.back();
    const Vector2d velocity = last.velocity_enu->head<2>();
    EXPECT_LT((velocity - VelocityAt(drawn, kDuration_s - 0.01)).norm(), 0.5) << Name(drawn);
    EXPECT_NEAR(last.velocity_enu->z(), 0, 0.3);
    ++checked;
  });
  EXPECT_EQ(checked, 36);
}

// Its pose, and so its centre, changes with the view although the camera's places are exact.
TEST(MotionPath, AVehicleHasNoiseOfItsOwn) {
  LocateOptions exact = PathOptions();
  exact.line.position_m = 0.01;
  for (const Drive drive : kDrives) {
    const Case drawn{.drive = drive, .flight_errors = 0};
    std::vector<LineOfSight> lines = DrawLines(drawn);
    for (LineOfSight& line : lines) line.azimuth_rad += 0.15 / *line.range_m * std::sin(4 * line.time_s);
    const auto path = EstimatePath(lines, exact);
    ASSERT_TRUE(path && path->is_moving) << Name(drawn);
    EXPECT_LT(ErrorOf(path->places.back(), drawn).head<2>().norm(), 1.5) << Name(drawn);
  }
}

// The truth of the place at every end of a flight, and of the speed, lies within the errors that are reported.
TEST(MotionPath, ErrorsAreWithinTheirSigmas) {
  int cases = 0;
  int inside = 0;
  int near_speed = 0;
  VisitCases(6, 1, [&](const Case& drawn) {
    const auto path = EstimatePath(DrawLines(drawn), PathOptions());
    ASSERT_TRUE(path && path->is_moving) << Name(drawn);
    const Geolocation& last = path->places.back();
    ++cases;
    inside += ErrorOf(last, drawn).head<2>().norm() <= last.ce90_m ? 1 : 0;
    const Vector2d off = last.velocity_enu->head<2>() - VelocityAt(drawn, kDuration_s - 0.01);
    constexpr double kQuantile90 = 4.6051702;  // of chi-squared, two degrees of freedom
    const Eigen::Matrix2d covariance = last.velocity_covariance_enu->topLeftCorner<2, 2>();
    near_speed += off.dot(covariance.inverse() * off) <= kQuantile90 ? 1 : 0;
  });
  const double all = cases;
  RecordProperty("ce90", std::to_string(inside / all));
  RecordProperty("velocity", std::to_string(near_speed / all));
  EXPECT_GE(inside / all, 0.84);
  EXPECT_LE(inside / all, 0.97);
  EXPECT_GE(near_speed / all, 0.84);
}

TEST(MotionPath, ParkedObjectDoesNotMove) {
  for (const CameraMotionKind flight : kPathFlights) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Case drawn{.flight = flight, .drive = Drive::kParked, .seed = seed};
      const auto path = EstimatePath(DrawLines(drawn), PathOptions());
      ASSERT_TRUE(path);
      EXPECT_FALSE(path->is_moving) << Name(drawn);
      EXPECT_TRUE(path->places.empty());
    }
  }
}

// Ranges that drift by three per cent over the flight, as those of a wrongly matched side do, are no motion.
TEST(MotionPath, DriftOfRangesIsNoMotion) {
  for (const CameraMotionKind flight : kPathFlights) {
    std::vector<LineOfSight> lines = DrawLines({.flight = flight, .drive = Drive::kParked, .flight_errors = 0});
    for (LineOfSight& line : lines) *line.range_m *= 1 + 0.03 * (line.time_s / kDuration_s - 0.5);
    const auto path = EstimatePath(lines, PathOptions());
    ASSERT_TRUE(path);
    EXPECT_FALSE(path->is_moving) << static_cast<int>(flight);
  }
}

// From a straight flight, lines alone fit a static place nearer or farther: the ranges decide.
TEST(MotionPath, RangesDecideWhereLinesAreAmbiguous) {
  std::vector<LineOfSight> lines;
  const TangentPlane plane(kOrigin);
  for (int i = 0; i < kCount; ++i) {
    const double time_s = kDuration_s * i / (kCount - 1);
    const Vector3d camera = CameraAt(CameraMotionKind::kStraight, time_s);
    const Vector3d line = Vector3d(-20 + 5 * time_s, 4, 1) - camera;  // half as fast as the camera
    lines.push_back({.time_s = time_s,
                     .camera = plane.GeodeticFromEnu(camera),
                     .azimuth_rad = std::atan2(line.x(), line.y()),
                     .elevation_rad = std::asin(line.z() / line.norm()),
                     .range_m = line.norm(),
                     .sigma_rad = 2e-4,
                     .sigma_range_m = 2});
  }
  const auto driving = EstimatePath(lines, PathOptions());
  ASSERT_TRUE(driving && driving->is_moving);
  EXPECT_NEAR(driving->places.back().velocity_enu->head<2>().norm(), 5, 0.1);
  for (LineOfSight& line : lines) *line.range_m *= 2;  // the place where the lines meet
  const auto parked = EstimatePath(lines, PathOptions());
  ASSERT_TRUE(parked);
  EXPECT_FALSE(parked->is_moving);
}

TEST(MotionPath, CrossesAGapAndIgnoresOutliers) {
  const Case hidden{.flight = CameraMotionKind::kHovering,
                    .drive = Drive::kStraight,
                    .flight_errors = 0,
                    .gap_from_s = 3,
                    .gap_to_s = 5};
  const auto through = EstimatePath(DrawLines(hidden), PathOptions());
  ASSERT_TRUE(through && through->is_moving);
  for (const Geolocation& place : through->places) EXPECT_LT(ErrorOf(place, hidden).head<2>().norm(), 1.5);
  const Case wrong{.flight = CameraMotionKind::kStraight, .drive = Drive::kCorner, .flight_errors = 0, .outliers = 8};
  const std::vector<LineOfSight> lines = DrawLines(wrong);
  const auto robust = EstimatePath(lines, PathOptions());
  ASSERT_TRUE(robust && robust->is_moving);
  EXPECT_LT(ErrorOf(robust->places.back(), wrong).head<2>().norm(), 1.5);
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(robust->inliers[i], i % 8 != 1) << i;
}

TEST(MotionPath, KnownGroundFixesTheDistance) {
  const Case drawn{.drive = Drive::kStraight, .range_factor = 1.03, .flight_errors = 0};
  LocateOptions options = PathOptions();
  options.common.height_m = 0.1;
  const double free_m = ErrorOf(EstimatePath(DrawLines(drawn), options)->places.back(), drawn).norm();
  options.ground = std::make_shared<const FlatGround>(kOrigin.altitude_m + kCentreHeight_m);
  options.ground_sigma_m = 0.2;
  const auto on_ground = EstimatePath(DrawLines(drawn), options);
  EXPECT_GT(free_m, 2);
  EXPECT_LT(ErrorOf(on_ground->places.back(), drawn).norm(), 1);
  options.ground = std::make_shared<const FlatGround>(kOrigin.altitude_m - 60);  // it flies: the ground says nothing
  EXPECT_NEAR(ErrorOf(EstimatePath(DrawLines(drawn), options)->places.back(), drawn).norm(), free_m, 1e-6);
}

TEST(MotionPath, NeedsThreeLinesWithRanges) {
  std::vector<LineOfSight> lines = DrawLines({});
  lines.resize(2);
  EXPECT_FALSE(EstimatePath(lines, PathOptions()));
  lines = DrawLines({});
  lines[4].range_m.reset();
  EXPECT_FALSE(EstimatePath(lines, PathOptions()));
}

}  // namespace
}  // namespace victorious
