#include "victorious/object/features/sift_keypoint.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

// Levels whose differences are a quadratic in x, y and layer with its maximum at a given place.
struct Quadratic {
  static constexpr int kSide = 24;
  std::vector<std::int16_t> pixels;
  OctaveLevels levels;

  Quadratic(double x0, double y0, double s0, double peak, double bend_x, double bend_y, double bend_s)
      : pixels(kernels::kLevels * kSide * kSide) {
    for (std::size_t l = 0; l < kernels::kLevels; ++l) {
      std::int16_t* const first = pixels.data() + l * kSide * kSide;
      levels[l] = {first, kSide, kSide, kSide};
      if (l == 0) continue;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          const double s = static_cast<double>(l) - 1;
          const double d =
              peak - bend_x * std::pow(x - x0, 2) - bend_y * std::pow(y - y0, 2) - bend_s * std::pow(s - s0, 2);
          first[y * kSide + x] = static_cast<std::int16_t>(levels[l - 1].Row(y)[x] + std::lround(d));
        }
      }
    }
  }
};

TEST(Refine, FindsTheMaximumOfAQuadratic) {
  const Quadratic image(11.3, 12.8, 2.2, 2000, 30, 25, 200);
  // From the nearest pixel, and from one beside it.
  for (const GridExtremum& start : {GridExtremum{0, 13, 11, 2}, GridExtremum{0, 12, 10, 2}}) {
    const auto refined = Refine(image.levels, start, {.contrast_threshold = 0.04, .edge_threshold = 10});
    ASSERT_TRUE(refined);
    EXPECT_EQ(refined->grid, (GridExtremum{0, 13, 11, 2}));
    EXPECT_NEAR(refined->x, 11.3, 0.02);
    EXPECT_NEAR(refined->y, 12.8, 0.02);
    EXPECT_NEAR(refined->layer, 2.2, 0.02);
    EXPECT_NEAR(refined->contrast, 2000 / (255.0 * kernels::kLevelUnit), 0.001);
    EXPECT_NEAR(refined->Sigma(), 1.6 * std::exp2(2.2 / 3), 0.02);
  }
}

TEST(Refine, RejectsFaintOnesAndEdges) {
  const Quadratic image(11.3, 12.8, 2.2, 2000, 30, 25, 200);
  const GridExtremum at{0, 13, 11, 2};
  const double contrast = 3 * 2000 / (255.0 * kernels::kLevelUnit);  // over all layers
  EXPECT_TRUE(Refine(image.levels, at, {.contrast_threshold = contrast - 0.005}));
  EXPECT_FALSE(Refine(image.levels, at, {.contrast_threshold = contrast + 0.005}));
  const Quadratic edge(11.3, 12.8, 2.2, 4000, 150, 10, 200);  // curvatures 15 to 1
  EXPECT_FALSE(Refine(edge.levels, at, {.contrast_threshold = 0.04, .edge_threshold = 13}));
  EXPECT_TRUE(Refine(edge.levels, at, {.contrast_threshold = 0.04, .edge_threshold = 17}));
}

TEST(Refine, RejectsWhatLeavesTheOctaveAndFlatness) {
  const Quadratic outside(2, 12, 2, 3000, 10, 10, 200);
  EXPECT_FALSE(Refine(outside.levels, {0, 12, 6, 2}, {}));
  const Quadratic flat(11, 12, 2, 1000, 0, 0, 0);
  EXPECT_FALSE(Refine(flat.levels, {0, 12, 11, 2}, {}));
}

TEST(FindPeaks, InterpolatesAndKeepsThoseAboveEightTenths) {
  std::array<std::int32_t, kernels::kOrientationBins> histogram{};
  EXPECT_EQ(FindPeaks(histogram).count, 0U);
  histogram[0] = 1000;
  histogram[35] = 400;
  histogram[1] = 600;
  histogram[20] = 1000;
  histogram[19] = histogram[21] = 450;
  histogram[10] = 1000;
  const Orientations found = FindPeaks(histogram);
  ASSERT_EQ(found.count, 2U);
  EXPECT_GT(found.bin[0], 0.0F);  // towards the larger neighbour
  EXPECT_LT(found.bin[0], 0.3F);
  EXPECT_FLOAT_EQ(found.bin[1], 20.0F);
}

TEST(OrientationWindows, GrowWithTheLayer) {
  const OrientationWindows windows;
  EXPECT_EQ(windows.At(0.5F).radius, 4);
  EXPECT_EQ(windows.At(3.5F).radius, 7);
  EXPECT_EQ(windows.At(9.0F).radius, 7);
}

}  // namespace
}  // namespace victorious
