#include "victorious/kernels/short_nearest.h"

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

ShortSet PackShort(std::span<const std::uint8_t> rows) {
  ShortSet set;
  set.count = rows.size() / kShortBytes;
  const std::size_t blocks = (set.count + kBlockDescriptors - 1) / kBlockDescriptors;
  set.blocks.assign(blocks * kBlockDescriptors * kShortBytes, 0);
  set.half_constant.assign(blocks * kBlockDescriptors, kShortPadding);
  for (std::size_t i = 0; i < set.count; ++i) {
    const std::uint8_t* row = rows.data() + i * kShortBytes;
    std::int32_t squared = 0;
    std::int32_t sum = 0;
    for (std::size_t byte = 0; byte < kShortBytes; ++byte) {
      squared += row[byte] * row[byte];
      sum += row[byte];
    }
    InterleaveRow({row, kShortBytes}, i, set.blocks.data());
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
