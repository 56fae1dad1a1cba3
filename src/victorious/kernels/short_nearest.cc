#include "victorious/kernels/short_nearest.h"

#include <cstring>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

namespace {

constexpr std::size_t kShortBlockBytes = kBlockDescriptors * kShortBytes;

// A set whose descriptors are to be written.
ShortSet MakeShortSet(std::size_t count) {
  ShortSet set;
  set.count = count;
  const std::size_t blocks = (count + kBlockDescriptors - 1) / kBlockDescriptors;
  set.blocks.resize(blocks * kShortBlockBytes);
  set.half_constant.assign(blocks * kBlockDescriptors, kShortPadding);
  return set;
}

}  // namespace

ShortSet PackShort(std::span<const std::uint8_t> rows) {
  ShortSet set = MakeShortSet(rows.size() / kShortBytes);
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

ShortSet SelectShort(const ShortSet& set, std::span<const std::uint32_t> numbers) {
  ShortSet selected = MakeShortSet(numbers.size());
  const auto lane = [](auto* blocks, std::size_t number) {
    return blocks + number / kBlockDescriptors * kShortBlockBytes + number % kBlockDescriptors * kGroupBytes;
  };
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint8_t* const from = lane(set.blocks.data(), numbers[i]);
    std::uint8_t* const to = lane(selected.blocks.data(), i);
    for (std::size_t at = 0; at < kShortBlockBytes; at += kBlockDescriptors * kGroupBytes) {
      std::memcpy(to + at, from + at, kGroupBytes);
    }
    selected.half_constant[i] = set.half_constant[numbers[i]];
  }
  return selected;
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
