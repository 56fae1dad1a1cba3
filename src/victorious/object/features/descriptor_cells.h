// features/, a fixed partition of shortened descriptors (kernels/shorten.h) into cells: UprightMatcher compares a
// template keypoint only with the scene keypoints that are nearest to the centre of its cell.
//
// The centres are k-means of the templates of the project's own CAD models: `victorious-experiment descriptor-cells`
// prints them. docs/adr/0018 has the fraction of true matches that a list of a cell's nearest scene keypoints holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "victorious/kernels/shorten.h"

namespace victorious {

inline constexpr std::size_t kDescriptorCells = 256;

/// The centre of a cell as a query of kernels/short_nearest.h.
[[nodiscard]] std::span<const std::int8_t> CellCentre(std::size_t cell);

/// Shortened descriptors of a template, prepared once and matched with many scenes.
struct ShortDescriptors {
  std::vector<std::int8_t> rows;     ///< kernels::ShortenToQueries
  std::vector<std::uint16_t> cells;  ///< of each row: the cell of the nearest centre
};

/// @param descriptors  kDescriptorSize bytes each
[[nodiscard]] ShortDescriptors ShortenDescriptors(std::span<const std::uint8_t> descriptors);

}  // namespace victorious
