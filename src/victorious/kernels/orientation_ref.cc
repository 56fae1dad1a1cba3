// The windows of orientation.h, and the definition of its histogram.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "victorious/base/check.h"
#include "victorious/kernels/orientation.h"
#include "victorious/kernels/orientation_bin.h"

namespace victorious::kernels {
namespace {

constexpr double kReach = 2.6;  // sigma

// The direction of (dx, dy), 0 to 36 * 256 bins / 256.
std::int32_t DirectionOf(int dx, int dy) {
  const float along_x = static_cast<float>(std::abs(dx));
  const float along_y = static_cast<float>(std::abs(dy));
  const float t = std::min(along_x, along_y) / std::max(std::max(along_x, along_y), 1.0F);
  const float t2 = t * t;
  float bin = t * (((kAtan7 * t2 + kAtan5) * t2 + kAtan3) * t2 + kAtan1);
  if (along_y > along_x) bin = kQuarterTurn - bin;
  if (dx < 0) bin = 2 * kQuarterTurn - bin;
  if (dy < 0) bin = 4 * kQuarterTurn - bin;
  return static_cast<std::int32_t>(bin * 256 + 0.5F);
}

}  // namespace

OrientationWindow MakeOrientationWindow(double sigma_px) {
  constexpr double kUnit = 4096;
  OrientationWindow window;
  const double sigma = sigma_px / kOrientationStep;  // samples
  window.radius = static_cast<int>(std::lround(kReach * sigma));
  VICTORIOUS_CHECK(window.radius >= 1 && window.radius <= kMaxOrientationRadius);
  const auto weight = [&](int i) {
    return static_cast<float>(std::round(kUnit * std::exp(-i * i / (2 * sigma * sigma))) / kUnit);
  };
  std::size_t n = 0;
  for (int j = -window.radius; j <= window.radius; ++j) {
    for (int i = -window.radius; i <= window.radius; ++i) window.weights[n++] = 16 * weight(j) * weight(i);
  }
  return window;
}

void OrientationHistogramRef(const LevelView& level, int x, int y, const OrientationWindow& window,
                             std::span<std::int32_t, kOrientationBins> histogram) {
  std::ranges::fill(histogram, 0);
  const float* weight = window.weights.data();
  for (int j = -window.radius; j <= window.radius; ++j) {
    for (int i = -window.radius; i <= window.radius; ++i, ++weight) {
      const int row = y + kOrientationStep * j;
      const int column = x + kOrientationStep * i;
      if (row < 1 || row > level.height - 2 || column < 1 || column > level.width - 2) continue;
      const int dx = level.Row(row)[column + 1] - level.Row(row)[column - 1];
      const int dy = level.Row(row + 1)[column] - level.Row(row - 1)[column];
      const float fx = static_cast<float>(dx);
      const float fy = static_cast<float>(dy);
      const auto part = static_cast<std::int32_t>(*weight * std::sqrt(fx * fx + fy * fy));
      const std::int32_t direction = DirectionOf(dx, dy);
      const std::int32_t upper = part * (direction & 255) >> 8;
      const auto bin = static_cast<std::size_t>(direction >> 8);
      histogram[bin % kOrientationBins] += part - upper;
      histogram[(bin + 1) % kOrientationBins] += upper;
    }
  }
}

}  // namespace victorious::kernels
