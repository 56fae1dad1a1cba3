#include "victorious/kernels/gradient_rows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

constexpr float kUntouchedGradient = -7;

std::vector<float> Noise(std::size_t count, Random& random) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random.Below(256));
  return values;
}

TEST(OrientGradients, DividesTheMagnitudeAmongTwoOrientations) {
  const std::vector<float> here = {0, 0, 6};
  std::vector<float> bins(kGradientBins);
  const float above = 0;
  const float below = 8;
  OrientGradientsRef(&above, here.data() + 1, &below, 1, 1, bins.data());
  const double position = 8 / 3.14159265358979 * std::atan2(8.0, 6.0);
  const auto lower = static_cast<std::size_t>(position);
  EXPECT_NEAR(bins[lower], 10 * (1 - (position - static_cast<double>(lower))), 1e-5);
  EXPECT_NEAR(bins[lower + 1], 10 * (position - static_cast<double>(lower)), 1e-5);
  EXPECT_EQ(std::ranges::count(bins, 0.0F), 6);
}

TEST(ReduceGradients, IsATriangleAtEverySecondPixel) {
  std::vector<float> in(2 * kGradientMargin + 8);
  in[kGradientMargin + 3] = 16;
  std::vector<float> out(4);
  ReduceGradientsRef(in.data() + kGradientMargin, 4, out.data());
  EXPECT_EQ(out, (std::vector<float>{1, 3, 3, 1}));
}

class GradientRowsTarget : public TargetTest {};

TEST_P(GradientRowsTarget, OrientsAsTheReference) {
  Random random(3);
  for (const std::size_t width : {1U, 2U, 7U, 16U, 33U, 250U}) {
    for (int i = 0; i < 4; ++i) {
      const std::size_t stride = width + kGradientPadding;
      std::vector<float> above = Noise(stride, random);
      std::vector<float> here = Noise(stride + 1, random);
      std::vector<float> below = Noise(stride, random);
      if (i == 1) std::ranges::fill(here, 9.0F);  // gradients along an axis, and none
      if (i == 2) above = below;
      if (i == 3) {
        std::ranges::fill(here, 9.0F);
        above = below;
      }
      std::vector<float> bins(kGradientBins * stride);
      std::vector<float> expected(bins.size());
      OrientGradients(above.data(), here.data() + 1, below.data(), width, stride, bins.data());
      OrientGradientsRef(above.data(), here.data() + 1, below.data(), width, stride, expected.data());
      for (std::size_t x = 0; x < width; ++x) {
        float magnitude = 0;
        for (std::size_t k = 0; k < kGradientBins; ++k) magnitude += expected[k * stride + x];
        for (std::size_t k = 0; k < kGradientBins; ++k) {
          EXPECT_NEAR(bins[k * stride + x], expected[k * stride + x], kMaxGradientError * magnitude)
              << width << ' ' << x;
        }
      }
    }
  }
}

TEST_P(GradientRowsTarget, FiltersAsTheReference) {
  Random random(4);
  for (const std::size_t columns : {1U, 2U, 15U, 16U, 17U, 100U}) {
    const std::vector<float> in = Noise(kGradientMargin + 2 * columns + kGradientPadding, random);
    std::vector<float> out(columns + kGradientPadding, kUntouchedGradient);
    std::vector<float> expected = out;
    ReduceGradients(in.data() + kGradientMargin, columns, out.data());
    ReduceGradientsRef(in.data() + kGradientMargin, columns, expected.data());
    std::array<const float*, kTriangleTaps> rows{};
    for (std::size_t t = 0; t < kTriangleTaps; ++t) rows[t] = in.data() + t;
    std::vector<float> summed = expected;
    std::vector<float> expected_sums = expected;
    SumGradientRows(rows, columns, summed.data());
    SumGradientRowsRef(rows, columns, expected_sums.data());
    for (std::size_t c = 0; c < columns; ++c) {
      EXPECT_NEAR(out[c], expected[c], 1e-3F) << columns << ' ' << c;
      EXPECT_NEAR(summed[c], expected_sums[c], 1e-3F) << columns << ' ' << c;
    }
  }
}

TEST_P(GradientRowsTarget, EncodesAsTheReference) {
  Random random(6);
  constexpr float kNoise2 = 4;
  constexpr float kScale = 283;
  for (const std::size_t cells : {1U, 3U, 16U, 31U, 100U}) {
    const std::size_t stride = cells + kGradientPadding;
    const std::vector<float> sums = Noise(kGradientBins * stride, random);
    std::vector<float> energy = Noise(stride, random);
    for (float& value : energy) value *= 1000;
    std::vector<std::uint8_t> out(kGradientBins * stride);
    std::vector<std::uint8_t> expected = out;
    EncodeGradients(sums.data(), stride, energy.data(), cells, kNoise2, kScale, out.data());
    EncodeGradientsRef(sums.data(), stride, energy.data(), cells, kNoise2, kScale, expected.data());
    for (std::size_t i = 0; i < kGradientBins * cells; ++i) EXPECT_NEAR(out[i], expected[i], 1) << cells << ' ' << i;
    EXPECT_GT(*std::ranges::max_element(expected), 200);
  }
}

VICTORIOUS_EVERY_TARGET(GradientRowsTarget);

}  // namespace
}  // namespace victorious::kernels
