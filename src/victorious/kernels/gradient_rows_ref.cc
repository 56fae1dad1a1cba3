// The reference implementation of the loops of gradient cells: one pixel at a time.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "victorious/kernels/gradient_rows.h"

namespace victorious::kernels {

void OrientGradientsRef(const float* above, const float* here, const float* below, std::size_t width,
                        std::size_t stride, float* bins) {
  for (std::size_t x = 0; x < width; ++x) {
    const double across = static_cast<double>(here[x + 1]) - *(here + x - 1);
    const double down = static_cast<double>(below[x]) - above[x];
    const double angle = std::atan2(down, across);
    const double position = kGradientBins / std::numbers::pi * (angle < 0 ? angle + std::numbers::pi : angle);
    for (std::size_t k = 0; k < kGradientBins; ++k) {
      const double apart = std::abs(position - static_cast<double>(k));
      const double weight = std::max(0.0, 1 - std::min(apart, kGradientBins - apart));
      bins[k * stride + x] = static_cast<float>(std::hypot(across, down) * weight);
    }
  }
}

void ReduceGradientsRef(const float* in, std::size_t columns, float* out) {
  for (std::size_t c = 0; c < columns; ++c) {
    double sum = 0;
    const float* const first = in + 2 * c - kTriangleReach;
    for (std::size_t j = 0; j < kTriangleTaps; ++j) sum += static_cast<double>(kTriangle[j]) * first[j];
    out[c] = static_cast<float>(sum);
  }
}

void SumGradientRowsRef(const std::array<const float*, kTriangleTaps>& rows, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0;
    for (std::size_t t = 0; t < kTriangleTaps; ++t) sum += static_cast<double>(kTriangle[t]) * rows[t][i];
    out[i] = static_cast<float>(sum);
  }
}

void EncodeGradientsRef(const float* sums, std::size_t stride, const float* energy, std::size_t cells, float noise2,
                        float scale, std::uint8_t* out) {
  for (std::size_t c = 0; c < cells; ++c) {
    const double norm = 1 / std::sqrt(static_cast<double>(energy[c]) + noise2);
    for (std::size_t k = 0; k < kGradientBins; ++k) {
      const double code = scale * std::sqrt(sums[k * stride + c] * norm) + 0.5;
      out[kGradientBins * c + k] = static_cast<std::uint8_t>(std::min(255.0, code));
    }
  }
}

}  // namespace victorious::kernels
