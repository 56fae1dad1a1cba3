#include "victorious/place/geolocate/ground_views.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kGround_m = 50;

// Straight down from 100 m: with tan(hfov / 2) = 0.3 a frame of 600 x 400 px shows 60 x 40 m, 10 px a metre.
GroundLook NadirLook(double east_m = 0, double yaw_deg = 0) {
  const TangentPlane plane({RadiansFromDegrees(48), RadiansFromDegrees(11), kGround_m + 100});
  GroundLook look{.camera = {}, .width_px = 600, .height_px = 400, .ground = std::make_shared<FlatGround>(kGround_m)};
  look.camera.place = plane.GeodeticFromEnu({east_m, 0, 0});
  look.camera.attitude = Attitude{.yaw_rad = RadiansFromDegrees(yaw_deg), .pitch_rad = -std::numbers::pi / 2};
  look.camera.hfov_rad = 2 * std::atan(0.3);
  return look;
}

std::size_t CellOf(const GroundCoverage& grid, double east_m, double north_m) {
  const TangentPlane plane({RadiansFromDegrees(48), RadiansFromDegrees(11), kGround_m});
  const GeodeticPoint point = plane.GeodeticFromEnu({east_m, north_m, 0});
  const int row = static_cast<int>(std::floor((grid.north_rad - point.latitude_rad) / grid.row_rad));
  const int column = static_cast<int>(std::floor((point.longitude_rad - grid.west_rad) / grid.column_rad));
  EXPECT_TRUE(row >= 0 && row < grid.rows && column >= 0 && column < grid.columns) << east_m << ", " << north_m;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
}

TEST(GroundViews, NadirFrameCoversItsRectangle) {
  const ViewDetectionOptions options{.half_size_px = 50, .slope = 2, .ceiling = 1};
  const auto coverage = CoverGround({NadirLook()}, {{"car", 5}}, options, {.cell_m = 1, .centre = {}});
  ASSERT_TRUE(coverage) << coverage.error().message;
  EXPECT_NEAR(coverage->columns, 60, 1);
  EXPECT_NEAR(coverage->rows, 40, 1);
  const std::size_t middle = CellOf(*coverage, 0, 0);
  EXPECT_EQ(coverage->looks[middle], 1);
  EXPECT_EQ(coverage->views[middle], 1);
  EXPECT_NEAR(coverage->models[0].size_px[middle], 50, 0.05);
  EXPECT_NEAR(coverage->models[0].probability[middle], 0.5, 1e-3);
  EXPECT_LT(DegreesFromRadians(coverage->off_nadir_rad[middle]), 0.5);
  const std::size_t corner = CellOf(*coverage, 28, 18);
  EXPECT_NEAR(coverage->models[0].size_px[corner], 50 / std::hypot(1, 0.28, 0.18), 0.1) << "farther from the camera";
  EXPECT_NEAR(std::tan(coverage->off_nadir_rad[corner]), std::hypot(0.28, 0.18), 0.01);
}

TEST(GroundViews, YawTurnsTheRectangle) {
  const auto coverage = CoverGround({NadirLook(0, 90)}, {{"car", 5}}, {}, {.cell_m = 1, .centre = {}});
  ASSERT_TRUE(coverage);
  EXPECT_NEAR(coverage->columns, 40, 1);
  EXPECT_NEAR(coverage->rows, 60, 1);
}

TEST(GroundViews, GroundBetweenFramesBelongsToTheAreaAndIsNotSeen) {
  const auto coverage = CoverGround({NadirLook(-50), NadirLook(50)}, {{"car", 5}}, {}, {.cell_m = 1, .centre = {}});
  ASSERT_TRUE(coverage);
  const std::size_t gap = CellOf(*coverage, 0, 0);
  EXPECT_EQ(coverage->in_area[gap], 1);
  EXPECT_EQ(coverage->looks[gap], 0);
  EXPECT_EQ(coverage->models[0].probability[gap], 0);
  EXPECT_EQ(coverage->looks[CellOf(*coverage, -50, 0)], 1);
  EXPECT_EQ(coverage->looks[CellOf(*coverage, 50, 0)], 1);
}

TEST(GroundViews, CircleIsTheArea) {
  const GeodeticPoint centre{RadiansFromDegrees(48), RadiansFromDegrees(11), 0};
  const auto coverage = CoverGround({NadirLook()}, {{"car", 5}}, {}, {.cell_m = 1, .centre = centre, .radius_m = 100});
  ASSERT_TRUE(coverage);
  const auto cells = std::ranges::count(coverage->in_area, 1);
  EXPECT_NEAR(static_cast<double>(cells), std::numbers::pi * 100 * 100, 200);
  const auto seen = std::ranges::count_if(coverage->looks, [](auto looks) { return looks > 0; });
  EXPECT_NEAR(static_cast<double>(seen), 60 * 40, 110);
}

TEST(GroundViews, DistortionMovesTheEdge) {
  GroundLook look = NadirLook();
  look.camera.distortion = std::array<double, 5>{0.5, 0, 0, 0, 0};  // pincushion: less ground is in the image
  const auto coverage = CoverGround({look}, {{"car", 5}}, {}, {.cell_m = 1, .centre = {}});
  ASSERT_TRUE(coverage);
  EXPECT_LE(coverage->columns, 59);
  EXPECT_EQ(coverage->looks[CellOf(*coverage, 0, 0)], 1);
}

TEST(GroundViews, SkyShowsNoGround) {
  GroundLook look = NadirLook();
  look.camera.attitude->pitch_rad = std::numbers::pi / 4;
  EXPECT_TRUE(GroundOutline(look).empty());
  EXPECT_FALSE(CoverGround({look}, {{"car", 5}}, {}, {.centre = {}}));
}

TEST(GroundViews, ChoosesCellsByTheArea) {
  const auto coverage =
      CoverGround({NadirLook()}, {{"car", 5}}, {}, {.cell_m = {}, .min_cell_m = 0.1, .max_cells = 1000, .centre = {}});
  ASSERT_TRUE(coverage);
  EXPECT_NEAR(coverage->cell_m, std::sqrt(60.0 * 40 / 1000), 0.02);
}

TEST(GroundViews, RefusesTooManyCells) {
  EXPECT_FALSE(CoverGround({NadirLook()}, {{"car", 5}}, {}, {.cell_m = 0.01, .centre = {}}));
}

TEST(GroundViews, HillHidesTheGroundBehindIt) {
  // A wall of 60 m across the way, 20 m east of the camera's place.
  class Wall final : public Ground {
   public:
    [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& point) const override {
      const TangentPlane plane({RadiansFromDegrees(48), RadiansFromDegrees(11), kGround_m});
      const double east_m = plane.EnuFromGeodetic(point).x();
      return east_m > 20 && east_m < 23 ? kGround_m + 60 : kGround_m;
    }
    [[nodiscard]] double Spacing() const override { return 0.5; }
    [[nodiscard]] double MaxSlope() const override { return 50; }
  };
  GroundLook look = NadirLook();
  look.camera.hfov_rad = 2 * std::atan(0.6);
  look.ground = std::make_shared<Wall>();
  const GeodeticPoint centre{RadiansFromDegrees(48), RadiansFromDegrees(11), 0};
  const auto coverage = CoverGround({look}, {{"car", 5}}, {}, {.cell_m = 1, .centre = centre, .radius_m = 58});
  ASSERT_TRUE(coverage);
  EXPECT_EQ(coverage->looks[CellOf(*coverage, -35, 0)], 1);
  EXPECT_EQ(coverage->looks[CellOf(*coverage, 35, 0)], 0) << "behind the wall";
}

}  // namespace
}  // namespace victorious
