#include "victorious/kernels/sift_descriptor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/level_test.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

using Descriptor = std::array<std::uint8_t, kDescriptorBytes>;

// A sum of waves of random directions, about as smooth as a level.
Level Waves(int width, int height, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::array<double, 4>> waves;
  for (int i = 0; i < 30; ++i) {
    const double angle = random.Uniform(0, 2 * std::numbers::pi);
    const double frequency = random.Uniform(0.05, 0.5);
    waves.push_back(
        {frequency * std::cos(angle), frequency * std::sin(angle), random.Uniform(0, 6), random.Uniform(50, 400)});
  }
  Level level(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (const auto& [fx, fy, phase, height_of] : waves) sum += height_of * std::sin(fx * x + fy * y + phase);
      level.At(x, y) = static_cast<std::int16_t>(std::lround(sum));
    }
  }
  return level;
}

double Cosine(std::span<const double> a, std::span<const std::uint8_t> b) {
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += a[i] * b[i];
    aa += a[i] * a[i];
    bb += static_cast<double>(b[i]) * b[i];
  }
  return ab / std::sqrt(aa * bb);
}

// Lowe's descriptor in floating point over every pixel of the window: central differences of pixels, directions by
// atan2, trilinear weights; clipped at 0.2, not scaled.
std::vector<double> Textbook(const LevelView& level, double x, double y, double cell_px, double angle) {
  std::vector<double> histogram(kDescriptorBytes);
  const int reach = static_cast<int>(std::ceil(cell_px * 2.5 * std::numbers::sqrt2));
  for (int py = static_cast<int>(y) - reach; py <= static_cast<int>(y) + reach; ++py) {
    for (int px = static_cast<int>(x) - reach; px <= static_cast<int>(x) + reach; ++px) {
      const double u = ((px - x) * std::cos(angle) + (py - y) * std::sin(angle)) / cell_px;
      const double v = ((py - y) * std::cos(angle) - (px - x) * std::sin(angle)) / cell_px;
      const double dx = level.Row(py)[px + 1] - level.Row(py)[px - 1];
      const double dy = level.Row(py + 1)[px] - level.Row(py - 1)[px];
      const double weight = std::hypot(dx, dy) * std::exp(-(u * u + v * v) / 8);
      double direction = (angle - std::atan2(dy, dx)) * 4 / std::numbers::pi;  // from +u over -v
      direction -= 8 * std::floor(direction / 8);
      for (int r = 0; r < 4; ++r) {
        for (int c = 0; c < 4; ++c) {
          const double share = std::max(0.0, 1 - std::abs(v - (r - 1.5))) * std::max(0.0, 1 - std::abs(u - (c - 1.5)));
          const int lower = static_cast<int>(direction) % 8;
          const double fraction = direction - std::floor(direction);
          const auto cell = static_cast<std::size_t>(8 * (4 * r + c));
          histogram[cell + static_cast<std::size_t>(lower)] += weight * share * (1 - fraction);
          histogram[cell + static_cast<std::size_t>((lower + 1) % 8)] += weight * share * fraction;
        }
      }
    }
  }
  double squares = 0;
  for (const double value : histogram) squares += value * value;
  for (double& value : histogram) value = std::min(value, 0.2 * std::sqrt(squares));
  return histogram;
}

DescriptorGrid GridAt(double x, double y, double cell_px, double angle) {
  return MakeDescriptorGrid(x, y, cell_px, std::cos(angle), std::sin(angle));
}

TEST(SiftDescriptor, IsCloseToTheTextbook) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Level level = Waves(100, 100, seed);
    for (const double angle : {0.0, 0.4, 1.3, 2.9, 4.4}) {
      for (const double cell_px : {5.4, 8.0, 10.8}) {
        Descriptor descriptor;
        DescribeSiftRef(level.view, GridAt(50.3, 49.8, cell_px, angle), descriptor);
        EXPECT_GT(Cosine(Textbook(level.view, 50.3, 49.8, cell_px, angle), descriptor), 0.97)
            << "seed " << seed << " angle " << angle << " cell " << cell_px;
      }
    }
  }
}

TEST(SiftDescriptor, TurnsWithTheImage) {
  constexpr int kSide = 90;
  Level level = Waves(kSide, kSide, 9);
  Level turned(kSide, kSide);  // clockwise: +x goes to +y
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) turned.At(kSide - 1 - y, x) = level.At(x, y);
  }
  Descriptor before;
  Descriptor after;
  DescribeSiftRef(level.view, GridAt(44.25, 40.5, 7, 0.6), before);
  DescribeSiftRef(turned.view, GridAt(kSide - 1 - 40.5, 44.25, 7, 0.6 + std::numbers::pi / 2), after);
  for (std::size_t i = 0; i < kDescriptorBytes; ++i) EXPECT_NEAR(before[i], after[i], 2) << i;
}

TEST(SiftDescriptor, OfASlopeHasOneDirection) {
  Level level(80, 80);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) level.At(x, y) = static_cast<std::int16_t>(-100 * y);  // rises upwards: direction 2
  }
  Descriptor descriptor;
  DescribeSiftRef(level.view, GridAt(40, 40, 6, 0), descriptor);
  for (std::size_t i = 0; i < kDescriptorBytes; ++i) {
    if (i % 8 == 2) {
      EXPECT_GT(descriptor[i], 50);
    } else {
      EXPECT_EQ(descriptor[i], 0);
    }
  }
}

TEST(SiftDescriptor, OfABlankLevelIsZero) {
  const Level level(80, 80);
  Descriptor descriptor;
  descriptor.fill(7);
  DescribeSiftRef(level.view, GridAt(40, 40, 6, 1), descriptor);
  EXPECT_EQ(descriptor, Descriptor{});
}

class SiftDescriptorTarget : public TargetTest {};

TEST_P(SiftDescriptorTarget, AgreesWithTheReference) {
  Random random(12);
  for (const int range : {0, 2, 200, kLevelOffset}) {
    for (const auto& [width, height] : {std::pair(90, 70), std::pair(11, 13)}) {
      Level level(width, height);
      for (std::int16_t& pixel : level.pixels) {
        pixel = static_cast<std::int16_t>(static_cast<int>(random.Below(static_cast<std::uint32_t>(2 * range + 1))) -
                                          range);
      }
      for (int trial = 0; trial < 300; ++trial) {  // borders included
        const DescriptorGrid grid = GridAt(random.Uniform(0, width - 1), random.Uniform(0, height - 1),
                                           random.Uniform(4.8, 12), random.Uniform(-3.2, 3.2));
        Descriptor expected;
        Descriptor descriptor;
        DescribeSiftRef(level.view, grid, expected);
        DescribeSift(level.view, grid, descriptor);
        ASSERT_EQ(descriptor, expected) << "trial " << trial << " range " << range;
      }
    }
  }
}

VICTORIOUS_EVERY_TARGET(SiftDescriptorTarget);

}  // namespace
}  // namespace victorious::kernels
