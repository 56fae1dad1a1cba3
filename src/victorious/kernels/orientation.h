// features/, the orientation of SIFT's keypoints: a histogram of gradient directions around a pixel of a level.
// Source: D. Lowe, IJCV 60(2), 2004, section 5.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "victorious/kernels/level.h"

namespace victorious::kernels {

inline constexpr std::size_t kOrientationBins = 36;
inline constexpr int kMaxOrientationRadius = 7;
inline constexpr int kOrientationStep = 2;  ///< px; levels of 1.8 px of blur and more need no finer samples

/// The samples x + kOrientationStep * i, y + kOrientationStep * j with |i|, |j| <= radius.
struct OrientationWindow {
  int radius = 0;  ///< samples
  /// Row by row, (2 radius + 1)^2 of them, then zeros.
  std::array<float, (2 * kMaxOrientationRadius + 1) * (2 * kMaxOrientationRadius + 1) + 15> weights{};
};

/// A Gaussian window of sigma_px, cut at 2.6 sigma. Weights are products of two multiples of 2^-12 along x and y, times
/// 16, so that libraries that differ in the last digit of exp() agree.
/// @param sigma_px  at most 5.5
OrientationWindow MakeOrientationWindow(double sigma_px);

/// Bin b stands for the direction 10 b degrees, from +x towards +y. A sample with the gradient
/// (dx, dy) = (L(x + 1, y) - L(x - 1, y), L(x, y + 1) - L(x, y - 1)) has the part trunc(weight * sqrt(dx^2 + dy^2)), in
/// single precision, each operation rounded. Its direction, a polynomial of the smaller over the larger component that
/// is exact to 0.01 degrees, is rounded to 1/256 bin; the part goes to the two nearest bins in proportion (the share of
/// the upper one is rounded down). Samples outside [1, width - 2] x [1, height - 2] add nothing.
/// @param x, y  px, inside the level
void OrientationHistogram(const LevelView& level, int x, int y, const OrientationWindow& window,
                          std::span<std::int32_t, kOrientationBins> histogram);
void OrientationHistogramRef(const LevelView& level, int x, int y, const OrientationWindow& window,
                             std::span<std::int32_t, kOrientationBins> histogram);

}  // namespace victorious::kernels
