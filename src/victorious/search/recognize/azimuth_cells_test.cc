#include "victorious/search/recognize/azimuth_cells.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kWidth_rad = RadiansFromDegrees(40);
constexpr double kTilt_rad = RadiansFromDegrees(20);
const Box kFrame{0, 0, 640, 480};

Vertical Camera(double off_nadir_deg, double hfov_deg) {
  return MakeVertical({0.3, RadiansFromDegrees(off_nadir_deg - 90), 0}, RadiansFromDegrees(hfov_deg), 640, 480);
}

TEST(AzimuthCells, NarrowFieldOfViewHasOneCell) {
  const Vertical vertical = Camera(45, 18);
  const AzimuthCells cells(vertical, kFrame, kWidth_rad);
  EXPECT_EQ(cells.CellCentresForView(RadiansFromDegrees(45), kTilt_rad).size(), 1);
  EXPECT_NEAR(cells.CellCentre(vertical.AzimuthAt({640, 480})), 0, 1e-9);
  EXPECT_NEAR(cells.OffNadirRange().first, RadiansFromDegrees(45 - 6.8), 0.02);
  EXPECT_NEAR(cells.OffNadirRange().second, RadiansFromDegrees(45 + 6.8), 0.02);
}

TEST(AzimuthCells, LinesAreWithinHalfACellOfTheCentre) {
  for (const double off_nadir_deg : {0.0, 20.0, 45.0, 70.0}) {
    const Vertical vertical = Camera(off_nadir_deg, 70);
    const AzimuthCells cells(vertical, kFrame, kWidth_rad);
    for (double x = 5; x < 640; x += 30) {
      for (double y = 5; y < 480; y += 30) {
        const double relative_azimuth_rad = vertical.AzimuthAt({x, y});
        EXPECT_LT(std::abs(relative_azimuth_rad - cells.CellCentre(relative_azimuth_rad)), RadiansFromDegrees(30))
            << off_nadir_deg;
      }
    }
  }
  EXPECT_GE(
      AzimuthCells(Camera(45, 70), kFrame, kWidth_rad).CellCentresForView(RadiansFromDegrees(45), kTilt_rad).size(), 2);
}

// A view has only the cells whose lines of sight can show it.
TEST(AzimuthCells, ObliqueViewHasFewCellsInANadirImage) {
  const AzimuthCells cells(Camera(20, 70), kFrame, kWidth_rad);
  EXPECT_LT(cells.CellCentresForView(RadiansFromDegrees(70), RadiansFromDegrees(15)).size(),
            cells.CellCentresForView(RadiansFromDegrees(10), RadiansFromDegrees(15)).size());
}

TEST(AzimuthCells, ImageRegionHasItsOwnCells) {
  const Vertical vertical = Camera(45, 70);
  const Box part{560, 200, 60, 60};
  const AzimuthCells cells(vertical, part, kWidth_rad);
  EXPECT_NEAR(cells.CellCentre(0), vertical.AzimuthAt({590, 230}), RadiansFromDegrees(3))
      << "the nearest, from outside";
}

TEST(AzimuthCells, MissingAttitudeAllowsAllViewsAndHasNoCells) {
  const AzimuthCells cells(std::nullopt, kFrame, kWidth_rad);
  EXPECT_EQ(cells.OffNadirRange(), (std::pair<double, double>{0, kPi}));
  EXPECT_TRUE(cells.CellCentresForView(1, 1).empty());
}

}  // namespace
}  // namespace victorious
