// The grid and weights of sift_descriptor.h, and the definition of its descriptor.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "victorious/kernels/sift_descriptor.h"

namespace victorious::kernels {
namespace {

constexpr std::size_t kSide = kGridSamples;
constexpr std::size_t kPoints = kGridPoints;
constexpr std::size_t kCells = kCellsPerSide;
constexpr std::size_t kDirections = kDescriptorDirections;

struct Points {
  std::int32_t value[kPoints][kPoints];  ///< [j][i]
  bool inside[kPoints][kPoints];
};

Points SamplePoints(const LevelView& level, const DescriptorGrid& grid) {
  Points points;
  for (int j = 0; j < kGridPoints; ++j) {
    for (int i = 0; i < kGridPoints; ++i) {
      const int a = 2 * i - (kGridPoints - 1);
      const int b = 2 * j - (kGridPoints - 1);
      const std::int32_t x = grid.fraction_x + a * grid.half_x - b * grid.half_y;
      const std::int32_t y = grid.fraction_y + a * grid.half_y + b * grid.half_x;
      int column = grid.x + (x >> 16);
      int row = grid.y + (y >> 16);
      int right = (x >> 8) & 255;
      int below = (y >> 8) & 255;
      const bool inside = column >= 0 && column < level.width - 1 && row >= 0 && row < level.height - 1;
      if (column < 0) right = 0;
      if (column > level.width - 2) right = 256;
      if (row < 0) below = 0;
      if (row > level.height - 2) below = 256;
      column = std::clamp(column, 0, level.width - 2);
      row = std::clamp(row, 0, level.height - 2);
      const std::int16_t* upper = level.Row(row) + column;
      const std::int16_t* lower = level.Row(row + 1) + column;
      const int top = upper[0] * (256 - right) + upper[1] * right;
      const int bottom = lower[0] * (256 - right) + lower[1] * right;
      points.value[j][i] = (top * (256 - below) + bottom * below + (1 << 15)) >> 16;
      points.inside[j][i] = inside;
    }
  }
  return points;
}

// The parts of a gradient along the 8 directions; those along diagonals lack the factor sqrt(2).
std::array<std::int32_t, kDirections> SplitGradient(int u, int v) {
  const auto positive = [](int value) { return std::max(value, 0); };
  const int along_u = std::abs(u);
  const int along_v = std::abs(v);
  return {positive(u - along_v),  std::min(positive(u), positive(-v)),
          positive(-v - along_u), std::min(positive(-u), positive(-v)),
          positive(-u - along_v), std::min(positive(-u), positive(v)),
          positive(v - along_u),  std::min(positive(u), positive(v))};
}

// The sum in the order of vectors of 8: element i is added to sum i % 8, and these pairwise at distance 4, 2, 1.
float SumOfSquares(std::span<const float, kDescriptorBytes> values) {
  float sums[8] = {};
  for (std::size_t i = 0; i < values.size(); ++i) sums[i % 8] += values[i] * values[i];
  for (std::size_t distance = 4; distance > 0; distance /= 2) {
    for (std::size_t i = 0; i < distance; ++i) sums[i] += sums[i + distance];
  }
  return sums[0];
}

}  // namespace

DescriptorGrid MakeDescriptorGrid(double x, double y, double cell_px, double direction_x, double direction_y) {
  constexpr double kUnit = 65536;
  const double half_px = cell_px / kSamplesPerCell / 2;
  DescriptorGrid grid;
  grid.x = static_cast<std::int32_t>(std::floor(x));
  grid.y = static_cast<std::int32_t>(std::floor(y));
  grid.fraction_x = static_cast<std::int32_t>((x - grid.x) * kUnit);
  grid.fraction_y = static_cast<std::int32_t>((y - grid.y) * kUnit);
  grid.half_x = static_cast<std::int32_t>(std::lround(half_px * direction_x * kUnit));
  grid.half_y = static_cast<std::int32_t>(std::lround(half_px * direction_y * kUnit));
  return grid;
}

const CellWeights& DescriptorCellWeights() {
  static const CellWeights kWeights = [] {
    constexpr double kWindow = kCellsPerSide / 2.0;  // sigma, cells
    CellWeights weights{};
    for (std::size_t i = 0; i < kSide; ++i) {
      const double cells = (static_cast<double>(i) - (kGridSamples - 1) / 2.0) / kSamplesPerCell;  // from the centre
      const double gaussian = std::exp(-cells * cells / (2 * kWindow * kWindow));
      for (std::size_t c = 0; c < kCells; ++c) {
        const double distance = std::abs(cells - (static_cast<double>(c) - (kCellsPerSide - 1) / 2.0));
        weights[c][i] = static_cast<std::int16_t>(std::lround(16384 * gaussian * std::max(0.0, 1 - distance)));
      }
    }
    return weights;
  }();
  return kWeights;
}

void DescribeSiftRef(const LevelView& level, const DescriptorGrid& grid,
                     std::span<std::uint8_t, kDescriptorBytes> out) {
  const Points points = SamplePoints(level, grid);
  const CellWeights& weights = DescriptorCellWeights();
  // Along y: columns[r][d][i], the weighted sums over the samples of column i.
  std::int32_t columns[kCells][kDirections][kSide] = {};
  for (std::size_t j = 0; j < kSide; ++j) {
    for (std::size_t i = 0; i < kSide; ++i) {
      if (!points.inside[j + 1][i + 1]) continue;
      const int u = points.value[j + 1][i + 2] - points.value[j + 1][i];
      const int v = points.value[j + 2][i + 1] - points.value[j][i + 1];
      const auto parts = SplitGradient(u, v);
      for (std::size_t r = 0; r < kCells; ++r) {
        for (std::size_t d = 0; d < kDirections; ++d) columns[r][d][i] += weights[r][j] * parts[d];
      }
    }
  }
  // Along x, on the column sums rounded to 16 bits.
  std::array<float, kDescriptorBytes> histogram;
  for (std::size_t r = 0; r < kCells; ++r) {
    for (std::size_t c = 0; c < kCells; ++c) {
      for (std::size_t d = 0; d < kDirections; ++d) {
        std::int32_t sum = 0;
        for (std::size_t i = 0; i < kSide; ++i) {
          sum += weights[c][i] * ((columns[r][d][i] + (1 << 15)) >> 16);
        }
        histogram[(r * kCells + c) * kDirections + d] = static_cast<float>(sum) * (d % 2 == 0 ? 1.0F : kSqrt2);
      }
    }
  }
  const float limit = 0.2F * std::sqrt(SumOfSquares(histogram));
  for (float& value : histogram) value = std::min(value, limit);
  const float norm = std::sqrt(SumOfSquares(histogram));
  const float factor = norm > 0 ? 512.0F / norm : 0.0F;
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = static_cast<std::uint8_t>(std::min(histogram[k] * factor + 0.5F, 255.0F));
  }
}

}  // namespace victorious::kernels
