// features/, the descriptor of SIFT, on a fixed grid of samples that turns and grows with the keypoint: the weights of
// the cells are then constants, and only the direction of each gradient is left to compute.
// Source: D. Lowe, IJCV 60(2), 2004, section 6 (a 16 x 16 sample array relative to the keypoint's orientation).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "victorious/kernels/descriptor.h"
#include "victorious/kernels/level.h"

namespace victorious::kernels {

inline constexpr int kGridSamples = 16;  ///< gradients along a side of the grid
inline constexpr int kGridPoints = kGridSamples + 2;

/// The grid spans the four cells and half a cell on each side, over which samples are shared with the border cells.
inline constexpr double kSamplesPerCell = kGridSamples / (kCellsPerSide + 1.0);

/// Where the grid lies. Point (i, j), 0 <= i, j < kGridPoints, is at
///   centre + ((2 i - 17) (half_x, half_y) + (2 j - 17) (-half_y, half_x)) / 65536 px;
/// the pixel centre (0, 0) of the level is the origin.
struct DescriptorGrid {
  std::int32_t x = 0;  ///< px, pixel to which the fraction is added
  std::int32_t y = 0;
  std::int32_t fraction_x = 0;  ///< px / 65536
  std::int32_t fraction_y = 0;
  std::int32_t half_x = 0;  ///< half of the spacing along the orientation, px / 65536
  std::int32_t half_y = 0;
};

/// @param x, y      px of the level, pixel centres at integers
/// @param cell_px   side of a cell (Lowe: 3 sigma)
/// @param direction_x, direction_y  unit vector of the orientation, y down
DescriptorGrid MakeDescriptorGrid(double x, double y, double cell_px, double direction_x, double direction_y);

/// 1. Points: bilinear values P of the level, in 1/256 px; a point outside takes the nearest value inside.
/// 2. Gradients: u = P(i + 1, j) - P(i - 1, j), v = P(i, j + 1) - P(i, j - 1), of the inner 16 x 16 points; 0 at points
///    outside the level.
/// 3. Directions: each gradient is split into its two neighbours among 8 directions, 45 degrees apart, as a sum of
///    vectors: along an axis | |u| - |v| |, along a diagonal sqrt(2) min(|u|, |v|). Directions count from +u over -v.
/// 4. Cells: trilinear weights times a Gaussian of half the grid's four cells, in 2^-14 along x and along y.
/// 5. Bytes: unit length, clipped at 0.2, unit length again, times 512, rounded, at most 255.
/// Steps 1 to 4 are integers (sqrt(2) excepted), step 5 is in single precision with a fixed order of sums.
/// @param out  cells row by row along v, in a row along u, 8 directions each; all 0 if there is no gradient
void DescribeSift(const LevelView& level, const DescriptorGrid& grid, std::span<std::uint8_t, kDescriptorBytes> out);
void DescribeSiftRef(const LevelView& level, const DescriptorGrid& grid, std::span<std::uint8_t, kDescriptorBytes> out);

inline constexpr float kSqrt2 = 1.41421356F;

/// weights[c][i]: of sample i in cell c, 2^-14.
using CellWeights = std::array<std::array<std::int16_t, kGridSamples>, kCellsPerSide>;
const CellWeights& DescriptorCellWeights();

}  // namespace victorious::kernels
