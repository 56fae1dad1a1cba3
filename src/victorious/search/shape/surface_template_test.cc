#include "victorious/search/shape/surface_template.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr int kTemplateSide = 24;

// A level square plate of 4 m, seen from above; its front half is dark.
VisibleSurface Plate() {
  VisibleSurface plate{.points = {}, .spacing_m = 0.05};
  for (int i = -40; i < 40; ++i) {
    for (int j = -40; j < 40; ++j) {
      plate.points.push_back({.position_m = {0.05F * (i + 0.5F), 0.05F * (j + 0.5F), 0},
                              .normal = {0, 0, 1},
                              .albedo = i >= 0 ? 0.1F : 0.9F});
    }
  }
  return plate;
}

CellTemplate Draw(const VisibleSurface& surface, const TemplateView& view,
                  TemplatePaint paint = TemplatePaint::kPlain) {
  return MakeTemplate(DrawCells(surface, view, kTemplateSide)[static_cast<std::size_t>(paint)],
                      BackgroundSpectrum({}, kTemplateSide));
}

double Strength(const CellTemplate& cells, int row, int column, int k) { return cells.at(row, column, k); }

// From above, the front upwards in the image: 40 px for 4 m, which are 5 cells on each side of the middle.
const TemplateView kFromAbove{.to_camera = {0, 0}, .to_sun = {}, .pixels_per_m = 10};

TEST(SurfaceTemplate, ShowsTheOutlineAroundTheMiddle) {
  const CellTemplate cells = Draw(Plate(), kFromAbove);
  const int middle = kTemplateSide / 2;
  // Left and right, edges are upright: gradients to the right. Above and below they are level.
  EXPECT_GT(Strength(cells, middle, middle - 5, 0), 0.2);
  EXPECT_GT(Strength(cells, middle, middle + 5, 0), 0.2);
  EXPECT_GT(Strength(cells, middle - 5, middle, 4), 0.2);
  EXPECT_GT(Strength(cells, middle + 5, middle, 4), 0.2);
  EXPECT_LT(Strength(cells, middle, middle - 5, 4), 0.1);
}

TEST(SurfaceTemplate, IsZeroBesideTheObject) {
  const CellTemplate cells = Draw(Plate(), kFromAbove);
  for (int k = 0; k < kCellOrientations; ++k) EXPECT_EQ(Strength(cells, 1, 1, k), 0);
}

TEST(SurfaceTemplate, OfOneGreyHasNoEdgesOfPaint) {
  const int middle = kTemplateSide / 2;
  EXPECT_LT(Strength(Draw(Plate(), kFromAbove), middle, middle, 4), 0.05);
  EXPECT_GT(Strength(Draw(Plate(), kFromAbove, TemplatePaint::kOwn), middle, middle, 4), 0.2);
}

TEST(SurfaceTemplate, HidesWhatLiesBehind) {
  VisibleSurface plates = Plate();
  for (SurfacePoint point : Plate().points) {
    point.position_m.z() = -1;
    point.albedo = 0.5F;
    plates.points.push_back(point);
  }
  EXPECT_EQ(Draw(plates, kFromAbove, TemplatePaint::kOwn).values,
            Draw(Plate(), kFromAbove, TemplatePaint::kOwn).values);
}

TEST(SurfaceTemplate, TheSunLightsWhatFacesIt) {
  // A roof: its two sides differ in the sun from one side, and not from above.
  VisibleSurface roof = Plate();
  for (SurfacePoint& point : roof.points) {
    point.normal = Eigen::Vector3f(point.position_m.x() > 0 ? 0.5F : -0.5F, 0, 0.8F).normalized();
  }
  TemplateView in_sun = kFromAbove;
  in_sun.to_sun = ViewDirection{.azimuth_rad = kPi, .off_nadir_rad = RadiansFromDegrees(60)};
  const int middle = kTemplateSide / 2;
  EXPECT_LT(Strength(Draw(roof, kFromAbove), middle, middle, 4), 0.05);
  EXPECT_GT(Strength(Draw(roof, in_sun), middle, middle, 4), 0.2);
}

TEST(SurfaceTemplate, WithoutPointsIsZero) {
  const CellTemplate cells = Draw({}, kFromAbove);
  EXPECT_TRUE(std::ranges::all_of(cells.values, [](float value) { return value == 0; }));
}

}  // namespace
}  // namespace victorious
