// The kernels of blur.h, and the definition of its rows.
#include <cmath>
#include <vector>

#include "victorious/base/check.h"
#include "victorious/kernels/blur.h"

namespace victorious::kernels {
namespace {

int MulRound(int a, int b) { return (a * b + (1 << 14)) >> 15; }

std::int16_t Halve(int sum) { return static_cast<std::int16_t>((sum + 1) >> 1); }

// Weights 0..radius of the unit-sum kernel exp(-k^2 / (2 s^2)).
std::vector<double> CutGaussian(double s, int radius) {
  std::vector<double> weights;
  double sum = 0;
  for (int k = 0; k <= radius; ++k) {
    weights.push_back(std::exp(-k * k / (2 * s * s)));
    sum += (k == 0 ? 1 : 2) * weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double Variance(const std::vector<double>& weights) {
  double sum = 0;
  for (std::size_t k = 1; k < weights.size(); ++k) sum += 2 * static_cast<double>(k * k) * weights[k];
  return sum;
}

// The Gaussian cut at `radius` that has the variance of an uncut one of sigma. The cut lowers the variance, so the
// parameter is a little above sigma.
std::vector<double> GaussianOfVariance(double sigma, int radius) {
  double low = sigma;
  double high = 2 * sigma;
  for (int step = 0; step < 50; ++step) {
    const double middle = (low + high) / 2;
    (Variance(CutGaussian(middle, radius)) < sigma * sigma ? low : high) = middle;
  }
  return CutGaussian((low + high) / 2, radius);
}

}  // namespace

BlurTaps MakeBlurTaps(double sigma_px) {
  constexpr int kSum = 1 << 16;
  BlurTaps kernel;
  kernel.radius = static_cast<int>(std::ceil(3 * sigma_px));
  VICTORIOUS_CHECK(sigma_px >= 0.85 && kernel.radius <= kMaxBlurRadius);
  const std::vector<double> weights = GaussianOfVariance(sigma_px, kernel.radius);
  int middle = kSum;
  for (int k = 1; k <= kernel.radius; ++k) {
    const auto index = static_cast<std::size_t>(k);
    kernel.taps[index] = static_cast<std::int16_t>(std::lround(weights[index] * kSum));
    middle -= 2 * kernel.taps[index];
  }
  VICTORIOUS_CHECK(middle < 1 << 15);
  kernel.taps[0] = static_cast<std::int16_t>(middle);
  return kernel;
}

void BlurColumnsRef(const std::int16_t* const* rows, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  const int r = kernel.radius;
  for (std::size_t x = 0; x < width; ++x) {
    int sum = MulRound(rows[r][x], kernel.taps[0]);
    for (int k = 1; k <= r; ++k) {
      sum += MulRound(rows[r - k][x] + rows[r + k][x], kernel.taps[static_cast<std::size_t>(k)]);
    }
    out[x] = Halve(sum);
  }
}

void BlurRowRef(const std::int16_t* in, const BlurTaps& kernel, std::size_t width, std::int16_t* out) {
  for (std::size_t x = 0; x < width; ++x, ++in) {
    int sum = MulRound(in[0], kernel.taps[0]);
    for (int k = 1; k <= kernel.radius; ++k) {
      sum += MulRound(in[-k] + in[k], kernel.taps[static_cast<std::size_t>(k)]);
    }
    out[x] = Halve(sum);
  }
}

DoublingTaps MakeDoublingTaps(double sigma_px) {
  constexpr int kRadius = 4;
  constexpr int kSum = 1 << 15;
  VICTORIOUS_CHECK(3 * sigma_px <= kRadius);
  const std::vector<double> gaussian = GaussianOfVariance(sigma_px, kRadius);
  // The doubled pixel n, relative to the even one: 1/4 and 3/4 of the two pixels around it.
  std::array<double, 2 * kDoublingReach> weights{};
  for (int n = -kRadius; n <= kRadius; ++n) {
    const double weight = gaussian[static_cast<std::size_t>(std::abs(n))];
    const int nearest = static_cast<int>(std::floor(n / 2.0));  // pixel i + nearest lies 1/4 from it
    const int other = n % 2 == 0 ? nearest - 1 : nearest + 1;
    weights[static_cast<std::size_t>(nearest + kDoublingReach)] += 0.75 * weight;
    weights[static_cast<std::size_t>(other + kDoublingReach)] += 0.25 * weight;
  }
  DoublingTaps kernel;
  int middle = kSum;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    kernel.taps[j] = static_cast<std::int16_t>(std::lround(weights[j] * kSum));
    if (j != kDoublingReach) middle -= kernel.taps[j];
  }
  kernel.taps[kDoublingReach] = static_cast<std::int16_t>(middle);
  return kernel;
}

void DoubleColumnsRef(const std::uint8_t* const* rows, const DoublingTaps& kernel, std::size_t width,
                      std::int16_t* even, std::int16_t* odd) {
  constexpr std::size_t kTaps = 2 * kDoublingReach;
  for (std::size_t x = 0; x < width; ++x) {
    int even_sum = 0;
    int odd_sum = 0;
    for (std::size_t j = 0; j < kTaps; ++j) {
      even_sum += MulRound(256 * rows[j][x] - 2 * kLevelOffset, kernel.taps[j]);
      odd_sum += MulRound(256 * rows[j + 1][x] - 2 * kLevelOffset, kernel.taps[kTaps - 1 - j]);
    }
    even[x] = Halve(even_sum);
    odd[x] = Halve(odd_sum);
  }
}

void DoubleRowRef(const std::int16_t* in, const DoublingTaps& kernel, std::size_t width, std::int16_t* out) {
  constexpr int kTaps = 2 * kDoublingReach;
  for (std::size_t x = 0; x < width; ++x, ++in) {
    int even_sum = 0;
    int odd_sum = 0;
    for (int j = 0; j < kTaps; ++j) {
      even_sum += MulRound(2 * in[j - kDoublingReach], kernel.taps[static_cast<std::size_t>(j)]);
      odd_sum += MulRound(2 * in[j - kDoublingReach + 1], kernel.taps[static_cast<std::size_t>(kTaps - 1 - j)]);
    }
    out[2 * x] = Halve(even_sum);
    out[2 * x + 1] = Halve(odd_sum);
  }
}

}  // namespace victorious::kernels
