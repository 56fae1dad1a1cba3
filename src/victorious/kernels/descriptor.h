// kernels/, the layout of a SIFT descriptor, shared by the kernel that makes it and those that match it.
#pragma once

#include <cstddef>

namespace victorious::kernels {

inline constexpr int kCellsPerSide = 4;          ///< of the grid of cells
inline constexpr int kDescriptorDirections = 8;  ///< per cell
/// One byte per cell and direction.
inline constexpr std::size_t kDescriptorBytes = std::size_t{kCellsPerSide} * kCellsPerSide * kDescriptorDirections;

}  // namespace victorious::kernels
