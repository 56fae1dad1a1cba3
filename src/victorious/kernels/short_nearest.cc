#include "victorious/kernels/short_nearest.h"

#include <cstring>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

ShortSet PackShort(std::span<const std::uint8_t> rows) {
  ShortSet set;
  set.count = rows.size() / kShortBytes;
  const std::size_t blocks = (set.count + kShortBlock - 1) / kShortBlock;
  set.blocks.assign(blocks * kShortBlock * kShortBytes, 0);
  set.half_constant.assign(blocks * kShortBlock, kShortPadding);
  for (std::size_t i = 0; i < set.count; ++i) {
    const std::uint8_t* row = rows.data() + i * kShortBytes;
    std::uint8_t* lane = set.blocks.data() + (i / kShortBlock) * kShortBlock * kShortBytes + (i % kShortBlock) * 4;
    std::int32_t squared = 0;
    std::int32_t sum = 0;
    for (std::size_t byte = 0; byte < kShortBytes; ++byte) {
      squared += row[byte] * row[byte];
      sum += row[byte];
    }
    for (std::size_t group = 0; group < kShortBytes / 4; ++group) {
      std::memcpy(lane + group * 4 * kShortBlock, row + group * 4, 4);
    }
    set.half_constant[i] = squared / 2 - kShortCentre * sum;
  }
  return set;
}

void FindShortNearest(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                      std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out) {
  static const bool has_vnni = HasVnni();
  if (has_vnni) {
    FindShortNearestVnni(queries, set, k, blocks, out);
  } else {
    FindShortNearestSimd(queries, set, k, blocks, out);
  }
}

void ComputeHalfDistances(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out) {
  ComputeHalfDistancesSimd(query, set, out);
}

}  // namespace victorious::kernels
