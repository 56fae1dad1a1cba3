#include "victorious/kernels/shorten.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/nearest.h"

namespace victorious::kernels {
namespace {

// A descriptor like SIFT's: a smooth histogram in each cell, of a norm of about 512.
std::vector<std::uint8_t> SmoothDescriptor(Random& random) {
  std::vector<std::uint8_t> row(kDescriptorBytes);
  for (std::size_t cell = 0; cell < 16; ++cell) {
    const double peak = 8 * random.Uniform();
    for (std::size_t bin = 0; bin < 8; ++bin) {
      const double off = std::remainder(static_cast<double>(bin) - peak, 8.0);
      row[cell * 8 + bin] = static_cast<std::uint8_t>(100 * std::exp(-0.5 * off * off));
    }
  }
  return row;
}

int Distance2(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  int squared = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squared += (a[i] - b[i]) * (a[i] - b[i]);
  return squared;
}

// An orthonormal basis shortens no vector by more than it leaves out: short distances bound full ones from below, up to
// the rounding of tables (3 % of the length) and of coefficients (at most 1 each).
TEST(Shorten, ShortDistancesAreLowerBounds) {
  Random random(1);
  for (int repetition = 0; repetition < 200; ++repetition) {
    const std::vector<std::uint8_t> a = SmoothDescriptor(random);
    const std::vector<std::uint8_t> b = SmoothDescriptor(random);
    const double full = std::sqrt(Distance2(a, b));
    const double shortened = 6 * std::sqrt(Distance2(Shorten(a), Shorten(b)));
    EXPECT_LT(shortened, 1.03 * full + 6 * std::sqrt(32.0));
  }
}

TEST(Shorten, KeepsNoisyDescriptorsNearest) {
  Random random(2);
  constexpr std::size_t kCount = 400;
  std::vector<std::vector<std::uint8_t>> originals;
  std::vector<std::vector<std::uint8_t>> shortened;
  for (std::size_t i = 0; i < kCount; ++i) {
    originals.push_back(SmoothDescriptor(random));
    shortened.push_back(Shorten(originals.back()));
  }
  int nearest = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    std::vector<std::uint8_t> noisy = originals[i];
    for (std::uint8_t& byte : noisy) byte = static_cast<std::uint8_t>(std::min(255U, byte + random.Below(60)));
    const std::vector<std::uint8_t> query = Shorten(noisy);
    const auto found = std::ranges::min_element(
        shortened, {}, [&](const std::vector<std::uint8_t>& row) { return Distance2(query, row); });
    nearest += found - shortened.begin() == static_cast<std::ptrdiff_t>(i) ? 1 : 0;
  }
  EXPECT_GT(nearest, static_cast<int>(0.95 * kCount));
}

TEST(Shorten, IsExactPerRowAndAtTheExtremes) {
  std::vector<std::uint8_t> rows(3 * kDescriptorBytes, 0);
  std::fill_n(rows.begin() + kDescriptorBytes, kDescriptorBytes, std::uint8_t{255});
  const std::vector<std::uint8_t> out = Shorten(rows);
  ASSERT_EQ(out.size(), 3 * kShortBytes);
  EXPECT_TRUE(std::equal(out.begin(), out.begin() + kShortBytes, out.begin() + 2 * kShortBytes));
  EXPECT_EQ(out[0], 64 - 48);           // 0 - 290 in steps of 6, rounded
  EXPECT_EQ(out[kShortBytes], 127);     // clipped: 255 * sqrt(128)
  EXPECT_EQ(out[kShortBytes + 2], 64);  // no period: the mean, 1 unit, rounds to no step
  EXPECT_TRUE(Shorten({}).empty());
}

}  // namespace
}  // namespace victorious::kernels
