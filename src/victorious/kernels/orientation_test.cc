#include "victorious/kernels/orientation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/level_test.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

using Histogram = std::array<std::int32_t, kOrientationBins>;

TEST(Orientation, WindowIsAGaussian) {
  const OrientationWindow window = MakeOrientationWindow(4);
  EXPECT_EQ(window.radius, 5);
  const std::size_t middle = 5 * 11 + 5;
  EXPECT_EQ(window.weights[middle], 16);
  EXPECT_NEAR(window.weights[middle + 2], 16 * std::exp(-0.5), 0.01);  // 2 samples are 4 px
  EXPECT_EQ(window.weights[middle + 2], window.weights[middle - 22]);
}

// The mean direction of a slope, by the two bins that share it.
TEST(Orientation, FindsTheDirectionOfASlope) {
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const double angle = degrees * std::numbers::pi / 180;
    Level level(40, 40);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) {
        level.At(x, y) = static_cast<std::int16_t>(std::lround(300 * (std::cos(angle) * x + std::sin(angle) * y)));
      }
    }
    Histogram histogram;
    OrientationHistogramRef(level.view, 20, 20, MakeOrientationWindow(4), histogram);
    double sum_x = 0;
    double sum_y = 0;
    std::size_t set = 0;
    for (std::size_t b = 0; b < kOrientationBins; ++b) {
      const double at = static_cast<double>(b) * std::numbers::pi / 18;
      sum_x += histogram[b] * std::cos(at);
      sum_y += histogram[b] * std::sin(at);
      if (histogram[b] > 0) ++set;
    }
    EXPECT_LE(set, 3U);
    EXPECT_NEAR(std::remainder(std::atan2(sum_y, sum_x) - angle, 2 * std::numbers::pi), 0, 0.006) << degrees;
  }
}

TEST(Orientation, OutsideAddsNothing) {
  Level level(3, 3);
  level.At(2, 1) = 1000;
  Histogram histogram;
  OrientationHistogramRef(level.view, 1, 1, MakeOrientationWindow(3), histogram);
  EXPECT_EQ(histogram[0], 16000);
  EXPECT_EQ(std::accumulate(histogram.begin(), histogram.end(), 0), 16000);
}

class OrientationTarget : public TargetTest {};

TEST_P(OrientationTarget, AgreesWithTheReference) {
  Random random(4);
  for (const int range : {1, 50, kLevelOffset}) {
    Level level(61, 47);
    for (std::int16_t& pixel : level.pixels) {
      pixel =
          static_cast<std::int16_t>(static_cast<int>(random.Below(static_cast<std::uint32_t>(2 * range + 1))) - range);
    }
    for (const double sigma : {1.0, 2.7, 3.6, 4.4, 5.4}) {
      const OrientationWindow window = MakeOrientationWindow(sigma);
      for (int y = 0; y < 47; y += 3) {
        for (int x = 0; x < 61; x += 2) {
          Histogram expected;
          Histogram histogram;
          OrientationHistogramRef(level.view, x, y, window, expected);
          OrientationHistogram(level.view, x, y, window, histogram);
          ASSERT_EQ(histogram, expected) << x << ", " << y << " sigma " << sigma;
        }
      }
    }
  }
}

VICTORIOUS_EVERY_TARGET(OrientationTarget);

}  // namespace
}  // namespace victorious::kernels
