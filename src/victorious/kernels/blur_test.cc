#include "victorious/kernels/blur.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

constexpr std::size_t kMargin = kRowMultiple;

// A row with margins on both sides, all readable.
std::vector<std::int16_t> RandomRow(Random& random, std::size_t width) {
  std::vector<std::int16_t> row(PaddedWidth(width) + 2 * kMargin);
  for (std::int16_t& pixel : row) {
    // A third at the extremes, where sums are largest.
    const std::uint32_t draw = random.Below(3 * (2 * kLevelOffset + 1));
    pixel = static_cast<std::int16_t>(draw > 4 * kLevelOffset   ? kLevelOffset
                                      : draw > 2 * kLevelOffset ? -kLevelOffset
                                                                : static_cast<int>(draw) - kLevelOffset);
  }
  return row;
}

std::vector<std::int16_t> First(const std::vector<std::int16_t>& row, std::size_t width) {
  return {row.begin(), row.begin() + static_cast<std::ptrdiff_t>(width)};
}

constexpr std::size_t kWidths[] = {1, 2, 7, 31, 32, 33, 63, 64, 65, 100, 517};
constexpr double kSigmas[] = {0.9, 1.226, 1.546, 1.946, 2.452, 3.09, 3.9};

TEST(BlurTaps, SumToOneAndHaveTheVariance) {
  for (const double sigma : kSigmas) {
    const BlurTaps kernel = MakeBlurTaps(sigma);
    int sum = kernel.taps[0];
    double variance = 0;
    for (int k = 1; k <= kernel.radius; ++k) {
      const int tap = kernel.taps[static_cast<std::size_t>(k)];
      EXPECT_LE(tap, kernel.taps[static_cast<std::size_t>(k - 1)]);
      sum += 2 * tap;
      variance += 2.0 * k * k * tap / 65536;
    }
    EXPECT_EQ(sum, 65536);
    EXPECT_NEAR(variance, sigma * sigma, 0.002 * sigma * sigma);
  }
}

TEST(Blur, IsTheGaussianToTwoUnits) {
  Random random(3);
  const std::size_t width = 100;
  for (const double sigma : kSigmas) {
    const BlurTaps kernel = MakeBlurTaps(sigma);
    const std::vector<std::int16_t> in = RandomRow(random, width);
    std::vector<std::int16_t> out(PaddedWidth(width));
    BlurRowRef(in.data() + kMargin, kernel, width, out.data());
    for (std::size_t x = 0; x < width; ++x) {
      double sum = 0;
      for (int k = -kernel.radius; k <= kernel.radius; ++k) {
        sum += kernel.taps[static_cast<std::size_t>(std::abs(k))] / 65536.0 *
               in[static_cast<std::size_t>(static_cast<int>(x + kMargin) + k)];
      }
      EXPECT_NEAR(out[x], sum, 2) << "sigma " << sigma << " x " << x;
    }
  }
}

TEST(Doubling, KeepsRampsAndLiesAQuarterPixelAside) {
  const DoublingTaps kernel = MakeDoublingTaps(1.249);
  const std::size_t width = 64;
  std::vector<std::int16_t> ramp(PaddedWidth(width) + 2 * kMargin);
  for (std::size_t x = 0; x < ramp.size(); ++x) ramp[x] = static_cast<std::int16_t>(100 * static_cast<int>(x) - 4000);
  std::vector<std::int16_t> out(2 * PaddedWidth(width));
  DoubleRowRef(ramp.data() + kMargin, kernel, width, out.data());
  for (std::size_t x = 0; x < width; ++x) {
    const int here = ramp[x + kMargin];
    EXPECT_NEAR(out[2 * x], here - 25, 2);
    EXPECT_NEAR(out[2 * x + 1], here + 25, 2);
  }
}

TEST(Doubling, MapsBlackAndWhiteToTheEndsOfTheRange) {
  const DoublingTaps kernel = MakeDoublingTaps(1.249);
  for (const int grey : {0, 255}) {
    const std::vector<std::uint8_t> row(40, static_cast<std::uint8_t>(grey));
    const std::vector<const std::uint8_t*> rows(2 * kDoublingReach + 1, row.data());
    std::vector<std::int16_t> even(64);
    std::vector<std::int16_t> odd(64);
    DoubleColumnsRef(rows.data(), kernel, row.size(), even.data(), odd.data());
    EXPECT_NEAR(even[7], kLevelUnit * grey - kLevelOffset, 1);
    EXPECT_NEAR(odd[7], kLevelUnit * grey - kLevelOffset, 1);
  }
}

class BlurTarget : public TargetTest {};

TEST_P(BlurTarget, AgreesWithTheReference) {
  Random random(5);
  for (const double sigma : kSigmas) {
    const BlurTaps kernel = MakeBlurTaps(sigma);
    const auto count = static_cast<std::size_t>(2 * kernel.radius + 1);
    for (const std::size_t width : kWidths) {
      std::vector<std::vector<std::int16_t>> rows;
      std::vector<const std::int16_t*> pointers;
      for (std::size_t i = 0; i < count; ++i) rows.push_back(RandomRow(random, width));
      for (const auto& row : rows) pointers.push_back(row.data());
      std::vector<std::int16_t> expected(PaddedWidth(width));
      std::vector<std::int16_t> out(PaddedWidth(width));
      BlurColumnsRef(pointers.data(), kernel, width, expected.data());
      BlurColumns(pointers.data(), kernel, width, out.data());
      EXPECT_EQ(First(out, width), First(expected, width)) << "columns, sigma " << sigma << " width " << width;
      BlurRowRef(rows[0].data() + kMargin, kernel, width, expected.data());
      BlurRow(rows[0].data() + kMargin, kernel, width, out.data());
      EXPECT_EQ(First(out, width), First(expected, width)) << "row, sigma " << sigma << " width " << width;
    }
  }
}

TEST_P(BlurTarget, DoublesAsTheReference) {
  Random random(6);
  const DoublingTaps kernel = MakeDoublingTaps(1.249);
  for (const std::size_t width : kWidths) {
    std::vector<std::vector<std::uint8_t>> rows(2 * kDoublingReach + 1, std::vector<std::uint8_t>(width));
    std::vector<const std::uint8_t*> pointers;
    for (auto& row : rows) {
      for (std::uint8_t& pixel : row) pixel = static_cast<std::uint8_t>(random.Below(256));
      pointers.push_back(row.data());
    }
    const std::size_t padded = PaddedWidth(width);
    std::vector<std::int16_t> expected_even(padded), expected_odd(padded), even(padded), odd(padded);
    DoubleColumnsRef(pointers.data(), kernel, width, expected_even.data(), expected_odd.data());
    DoubleColumns(pointers.data(), kernel, width, even.data(), odd.data());
    EXPECT_EQ(First(even, width), First(expected_even, width)) << width;
    EXPECT_EQ(First(odd, width), First(expected_odd, width)) << width;
    const std::vector<std::int16_t> in = RandomRow(random, width);
    std::vector<std::int16_t> expected(2 * padded);
    std::vector<std::int16_t> out(2 * padded);
    DoubleRowRef(in.data() + kMargin, kernel, width, expected.data());
    DoubleRow(in.data() + kMargin, kernel, width, out.data());
    EXPECT_EQ(First(out, 2 * width), First(expected, 2 * width)) << width;
  }
}

VICTORIOUS_EVERY_TARGET(BlurTarget);

}  // namespace
}  // namespace victorious::kernels
