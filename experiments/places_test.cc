// Places compared with surveyed or recorded ones, on external real data.
#include <algorithm>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "experiments/place_experiments.h"
#include "experiments/place_trials.h"
#include "testing/data.h"
#include "victorious/geometry/angles.h"
#include "victorious/lab/evaluate/place_score.h"
#include "victorious/place/geolocate/locate.h"

namespace victorious {
namespace {

ExperimentSettings Settings() { return {.data = testing::DataPath(""), .scenes = {}, .out = ::testing::TempDir()}; }

double ParseNumber(const Report& report, const std::vector<Cell>& row, std::string_view column) {
  const auto at = static_cast<std::size_t>(std::ranges::find(report.columns, column) - report.columns.begin());
  const double* number = std::get_if<double>(&row.at(at));
  EXPECT_NE(number, nullptr) << column;
  return number != nullptr ? *number : 0;
}

std::string TextIn(const Report& report, const std::vector<Cell>& row, std::string_view column) {
  const auto at = static_cast<std::size_t>(std::ranges::find(report.columns, column) - report.columns.begin());
  return std::get<std::string>(row.at(at));
}

// Locates a trial's point from its first lines, with ground at the point's surveyed height.
Geolocation PlaceOnGround(const PlaceTrial& trial, std::size_t lines, LocateMethod method) {
  LocateOptions options = trial.locate_options;
  options.method = method;
  options.ground = std::make_shared<FlatGround>(trial.truth.altitude_m);
  options.ground_sigma_m = 0.05;
  const auto fix = Locate(std::span(trial.lines).first(lines), options);
  EXPECT_TRUE(fix && fix->place) << trial.point << ": " << (fix ? StatusText(*fix) : fix.error().message);
  return fix && fix->place ? *fix->place : Geolocation{};
}

TEST(Lines, PassThroughTheirUndistortedPixel) {
  const GeoreferencedCamera camera{
      .pinhole = {.fx = 1000, .fy = 1000, .cx = 400, .cy = 300, .width = 800, .height = 600},
      .lens = {-0.3, 0.05, 0.001, 0, 0},
      .place = {0.5, 0.2, 100},
      .attitude = {.yaw_rad = 1, .pitch_rad = -0.6, .roll_rad = 0.2}};
  const Eigen::Vector3d point(0.3, -0.2, 1);  // right, down, ahead
  const Eigen::Vector2d pixel = 1000 * Distort(point.head<2>(), camera.lens) + Eigen::Vector2d(400, 300);
  const LineOfSight line = LineOfSightThrough(pixel, camera, 3);
  const Eigen::Vector3d direction = CameraFromEnu(camera.attitude).conjugate() * point.normalized();
  EXPECT_NEAR(line.elevation_rad, std::asin(direction.z()), 1e-8);
  EXPECT_NEAR(line.azimuth_rad, std::atan2(direction.x(), direction.y()), 1e-8);
  EXPECT_NEAR(*line.sigma_rad, 0.001, 1e-12);
  EXPECT_EQ(line.time_s, 3);
}

TEST(Places, SurveyedPointsFromAHoveringCamera) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/geo_gcp/narrabeen_uav/truth.json");
  const auto beach = LoadNarrabeen(Settings());
  ASSERT_TRUE(beach) << beach.error().message;
  ASSERT_EQ(beach->size(), 3U);
  const PlaceSeries& solved = beach->at(0);
  ASSERT_EQ(solved.trials.size(), 4U);
  for (const PlaceTrial& trial : solved.trials) {
    EXPECT_EQ(trial.lines.size(), 11U) << trial.point << ": seen again in every image";
    const Geolocation one = PlaceOnGround(trial, 1, LocateMethod::kGround);
    const PlaceError error = ComputePlaceError(one, std::nullopt, TruthRow{.place = trial.truth});
    EXPECT_LT(*error.horizontal_error_m, 0.3) << trial.point;
    for (const LocateMethod method :
         {LocateMethod::kGround, LocateMethod::kMaximumLikelihood, LocateMethod::kRansac, LocateMethod::kPrior}) {
      const Geolocation all = PlaceOnGround(trial, trial.lines.size(), method);
      EXPECT_GT(all.ce90_m, 0.9 * one.ce90_m) << trial.point << ", " << ToText(kLocateMethodTexts, method);
      EXPECT_TRUE(ComputePlaceError(all, std::nullopt, TruthRow{.place = trial.truth}).in_ellipsoid)
          << trial.point << ", " << ToText(kLocateMethodTexts, method);
    }
  }
  // The telemetry is wrong by 3 degrees; with that standard deviation stated, the ellipsoids contain the truth.
  for (const PlaceTrial& trial : beach->at(2).trials) {
    const Geolocation place = PlaceOnGround(trial, 1, LocateMethod::kMaximumLikelihood);
    const PlaceError error = ComputePlaceError(place, std::nullopt, TruthRow{.place = trial.truth});
    EXPECT_GT(*error.horizontal_error_m, 15) << trial.point;
    EXPECT_TRUE(error.in_ellipsoid) << trial.point;
  }
}

TEST(Places, SurveyedPointsFromAFixedCamera) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/geo_gcp/geul_river/dk_cam_config.json");
  const auto river = LoadGeul(Settings());
  ASSERT_TRUE(river) << river.error().message;
  ASSERT_EQ(river->trials.size(), 6U);
  for (const PlaceTrial& trial : river->trials) {
    const Geolocation one = PlaceOnGround(trial, 1, LocateMethod::kGround);
    const PlaceError error = ComputePlaceError(one, std::nullopt, TruthRow{.place = trial.truth});
    EXPECT_LT(*error.horizontal_error_m, 0.4) << trial.point;
    EXPECT_TRUE(error.in_ellipsoid) << trial.point;
    for (const LocateMethod method :
         {LocateMethod::kGround, LocateMethod::kMaximumLikelihood, LocateMethod::kRansac, LocateMethod::kPrior}) {
      const Geolocation all = PlaceOnGround(trial, trial.lines.size(), method);
      EXPECT_GT(all.ce90_m, 0.999 * one.ce90_m)
          << trial.point << ", " << ToText(kLocateMethodTexts, method) << ": one line thirty times";
    }
  }
}

TEST(Places, StaresOfARealFlightAreInTheirEllipsoids) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/fmv_klv/raw_packets/Cheyenne.bin");
  const auto report = RunTableCheyenne(Settings());
  ASSERT_TRUE(report) << report.error().message;
  std::map<std::string, double> error_m;
  for (const auto& row : report->rows) {
    const std::string stare = TextIn(*report, row, "packets");
    EXPECT_EQ(TextIn(*report, row, "in the 90 % ellipsoid"), "yes") << stare;
    if (TextIn(*report, row, "method") == "ransac") error_m[stare] = ParseNumber(*report, row, "in space, m");
  }
  ASSERT_EQ(error_m.size(), 4U);
  EXPECT_LT(error_m["15 to 120"], 10);
  EXPECT_LT(error_m["191 to 326"], 10);
}

TEST(Places, OneObjectInSeveralPhotosIsConsistent) {
  VICTORIOUS_DATA_OR_SKIP(path, "real/geo_gcp/brighton_beach/telemetry.csv");
  const auto report = RunTableBrighton(Settings());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GE(report->rows.size(), 30U) << "five objects, six ways each";
  for (const auto& row : report->rows) {
    const double photos = ParseNumber(*report, row, "photos");
    EXPECT_GE(photos, 2) << TextIn(*report, row, "object");
    EXPECT_EQ(TextIn(*report, row, "within their CE90"),
              std::to_string(int(photos)) + " of " + std::to_string(int(photos)))
        << TextIn(*report, row, "object") << ", " << TextIn(*report, row, "method");
    EXPECT_LT(ParseNumber(*report, row, "photos alone: max distance from joint place, m"), 4)
        << TextIn(*report, row, "object");
  }
}

TEST(Places, ErrorNamesMissingData) {
  const ExperimentSettings settings{.data = "/nowhere", .scenes = {}, .out = ::testing::TempDir()};
  EXPECT_NE(RunTableCheyenne(settings).error().message.find("/nowhere/real/fmv_klv"), std::string::npos);
  EXPECT_NE(RunTableControlPoints(settings).error().message.find("/nowhere/real/geo_gcp"), std::string::npos);
  EXPECT_NE(RunTableBrighton(settings).error().message.find("/nowhere/real/geo_gcp"), std::string::npos);
}

}  // namespace
}  // namespace victorious
