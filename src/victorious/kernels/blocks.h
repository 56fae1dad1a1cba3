// The layout that nearest.h and short_nearest.h search: descriptors in blocks of 16, interleaved in groups of 4 bytes,
//   block[row bytes / 4 groups][16 descriptors][4 bytes]
// so that one load serves 16 descriptors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace victorious::kernels {

inline constexpr std::size_t kBlockDescriptors = 16;

/// Writes a descriptor to its place in the blocks.
inline void InterleaveRow(std::span<const std::uint8_t> row, std::size_t descriptor, std::uint8_t* blocks) {
  std::uint8_t* const lane =
      blocks + (descriptor / kBlockDescriptors) * kBlockDescriptors * row.size() + (descriptor % kBlockDescriptors) * 4;
  for (std::size_t group = 0; group < row.size() / 4; ++group) {
    std::memcpy(lane + group * 4 * kBlockDescriptors, row.data() + group * 4, 4);
  }
}

}  // namespace victorious::kernels
