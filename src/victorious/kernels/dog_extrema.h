// features/, the detector of SIFT: extrema of the differences of Gaussians, which are never stored.
// Source: D. Lowe, IJCV 60(2), 2004, section 3.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "victorious/kernels/level.h"

namespace victorious::kernels {

/// Layers of an octave that are searched, and the levels that they take.
inline constexpr std::size_t kSearchedLayers = 3;
inline constexpr std::size_t kLevels = kSearchedLayers + 3;

/// The rows y - 1, y and y + 1 of each level of an octave, readable to PaddedWidth(width).
struct LevelRows {
  std::array<std::array<const std::int16_t*, 3>, kLevels> row{};
};

struct DogExtremum {
  std::int32_t x = 0;
  std::int32_t layer = 0;  ///< 1 to kSearchedLayers: the difference of levels layer + 1 and layer

  bool operator==(const DogExtremum&) const = default;
};

/// The extrema of row y in [first_x, end_x): D = level[layer + 1] - level[layer] with D > threshold and D >= its 26
/// neighbours in x, y and layer, or D < -threshold and D <= them.
/// @param first_x  >= 1;  @param end_x  <= width - 1;  @param threshold  >= 0
/// @param out  room for kSearchedLayers * (end_x - first_x)
/// @return the number of extrema, ascending in x, then in layer
std::size_t FindDogExtrema(const LevelRows& rows, std::int32_t first_x, std::int32_t end_x, std::int16_t threshold,
                           DogExtremum* out);
std::size_t FindDogExtremaRef(const LevelRows& rows, std::int32_t first_x, std::int32_t end_x, std::int16_t threshold,
                              DogExtremum* out);

}  // namespace victorious::kernels
