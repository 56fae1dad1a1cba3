#include "victorious/kernels/shorten.h"

#include <algorithm>
#include <cstddef>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {
namespace {

constexpr std::size_t kCells = 4;  // a row or a column
constexpr std::size_t kBins = 8;

// 16 times the orthonormal basis, rounded: a row per frequency.
constexpr float kCosine[kCells][kCells] = {{8, 8, 8, 8}, {10, 4, -4, -10}, {8, -8, -8, 8}, {4, -10, 10, -4}};
// Constant, then cosine and sine of one, two and three periods, then alternating.
constexpr float kFourier[kBins][kBins] = {
    {6, 6, 6, 6, 6, 6, 6, 6},   {8, 6, 0, -6, -8, -6, 0, 6}, {0, 6, 8, 6, 0, -6, -8, -6}, {8, 0, -8, 0, 8, 0, -8, 0},
    {0, 8, 0, -8, 0, 8, 0, -8}, {8, -6, 0, 6, -8, 6, 0, -6}, {0, 6, -8, 6, 0, -6, 8, -6}, {6, -6, 6, -6, 6, -6, 6, -6}};
constexpr float kBasisScale = 16.0F * 16.0F * 16.0F;

// A coefficient of the transform and its mean over the views of 25 CAD models, in units of the descriptor.
struct Coefficient {
  std::uint8_t row_frequency;
  std::uint8_t column_frequency;
  std::uint8_t bin_frequency;  // row of kFourier
  std::int16_t mean;
};

// By frequency, so that coefficients of the same cells' frequencies are neighbours.
constexpr Coefficient kCoefficients[kShortBytes] = {
    {0, 0, 0, 290}, {0, 0, 1, 82},  {0, 0, 2, 1},   {0, 0, 3, 108}, {0, 0, 4, 0},  {0, 0, 5, 40}, {0, 0, 7, 52},
    {0, 1, 0, 6},   {0, 1, 1, -21}, {0, 1, 2, 0},   {0, 1, 3, -2},  {0, 1, 4, 0},  {0, 1, 5, -8}, {0, 2, 0, -59},
    {0, 2, 1, -81}, {0, 2, 3, -46}, {0, 2, 5, -32}, {0, 3, 1, 7},   {0, 3, 5, 3},  {1, 0, 0, 0},  {1, 0, 1, 0},
    {1, 0, 2, 10},  {1, 0, 3, 0},   {1, 0, 4, 2},   {1, 1, 1, 0},   {1, 1, 2, 22}, {1, 2, 1, 0},  {1, 2, 2, -3},
    {2, 0, 2, 1},   {2, 1, 2, 0},   {2, 3, 1, -1},  {3, 0, 2, -1}};
// The range of a coefficient, -384 to 378 about its mean, is four standard deviations of the most variable one.
constexpr float kUnitsPerStep = 6;
constexpr int kMaxShort = 127;
constexpr float kPositive = 2048;  // more than any coefficient in steps

}  // namespace

std::vector<std::uint8_t> Shorten(std::span<const std::uint8_t> rows) {
  constexpr std::size_t kRowValues = kCells * kBins;
  const std::size_t count = rows.size() / kDescriptorBytes;
  std::vector<std::uint8_t> out(count * kShortBytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* bytes = rows.data() + i * kDescriptorBytes;
    // Floats hold integers here, at most 255 * 32 * 32 * 48 < 2^24: exact in any order.
    float values[kDescriptorBytes];
    for (std::size_t k = 0; k < kDescriptorBytes; ++k) values[k] = bytes[k];
    float by_row[kCells][kRowValues] = {};        // row frequency; column, bin
    float by_column[kCells][kCells][kBins] = {};  // row frequency, column frequency, bin
    for (std::size_t u = 0; u < kCells; ++u) {
      for (std::size_t row = 0; row < kCells; ++row) {
        for (std::size_t k = 0; k < kRowValues; ++k) by_row[u][k] += kCosine[u][row] * values[row * kRowValues + k];
      }
      for (std::size_t v = 0; v < kCells; ++v) {
        for (std::size_t column = 0; column < kCells; ++column) {
          for (std::size_t bin = 0; bin < kBins; ++bin) {
            by_column[u][v][bin] += kCosine[v][column] * by_row[u][column * kBins + bin];
          }
        }
      }
    }
    for (std::size_t k = 0; k < kShortBytes; ++k) {
      const Coefficient& wanted = kCoefficients[k];
      const float* fourier = kFourier[wanted.bin_frequency];
      const float* cell = by_column[wanted.row_frequency][wanted.column_frequency];
      float sums[kBins / 2];
      for (std::size_t bin = 0; bin < kBins / 2; ++bin) {
        sums[bin] = fourier[bin] * cell[bin] + fourier[bin + kBins / 2] * cell[bin + kBins / 2];
      }
      const float value = (sums[0] + sums[1] + sums[2] + sums[3]) / kBasisScale - static_cast<float>(wanted.mean);
      // Rounds by truncating a positive number: std::floor is a call on the oldest processors.
      const int steps = static_cast<int>(value / kUnitsPerStep + kPositive + 0.5F) - static_cast<int>(kPositive);
      out[i * kShortBytes + k] = static_cast<std::uint8_t>(std::clamp(kShortCentre + steps, 0, kMaxShort));
    }
  }
  return out;
}

std::vector<std::int8_t> ShortenToQueries(std::span<const std::uint8_t> rows) {
  const std::vector<std::uint8_t> shortened = Shorten(rows);
  std::vector<std::int8_t> queries(shortened.size());
  std::ranges::transform(shortened, queries.begin(),
                         [](std::uint8_t value) { return static_cast<std::int8_t>(value - kShortCentre); });
  return queries;
}

}  // namespace victorious::kernels
