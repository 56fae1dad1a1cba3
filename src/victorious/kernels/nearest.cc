#include "victorious/kernels/nearest.h"

#include <cstring>

#include "victorious/kernels/k_nearest.h"
#include "victorious/kernels/short_nearest.h"

namespace victorious::kernels {
PackedDescriptors Pack(std::span<const std::uint8_t> rows, std::size_t row_bytes) {
  PackedDescriptors set;
  set.count = rows.size() / row_bytes;
  set.row_bytes = row_bytes;
  const std::size_t blocks = (set.count + kBlockDescriptors - 1) / kBlockDescriptors;
  set.blocks.assign(blocks * kBlockDescriptors * row_bytes, 0);
  set.constant.assign(blocks * kBlockDescriptors, row_bytes == kShortBytes ? kShortPaddingDistance : kPaddingDistance);
  for (std::size_t i = 0; i < set.count; ++i) {
    const std::uint8_t* row = rows.data() + i * row_bytes;
    std::uint8_t* lane =
        set.blocks.data() + (i / kBlockDescriptors) * kBlockDescriptors * row_bytes + (i % kBlockDescriptors) * 4;
    std::int32_t squared = 0;
    std::int32_t sum = 0;
    for (std::size_t byte = 0; byte < row_bytes; ++byte) {
      squared += row[byte] * row[byte];
      sum += row[byte];
    }
    for (std::size_t group = 0; group < row_bytes / 4; ++group) {
      std::memcpy(lane + group * 4 * kBlockDescriptors, row + group * 4, 4);
    }
    set.constant[i] = squared - 256 * sum;
  }
  return set;
}

PackedQueries PackQueries(std::span<const std::uint8_t> rows, std::size_t row_bytes) {
  PackedQueries queries;
  queries.count = rows.size() / row_bytes;
  queries.row_bytes = row_bytes;
  queries.rows.resize(queries.count * row_bytes);
  queries.squared.resize(queries.count);
  for (std::size_t q = 0; q < queries.count; ++q) {
    std::int32_t squared = 0;
    for (std::size_t byte = q * row_bytes; byte < (q + 1) * row_bytes; ++byte) {
      squared += rows[byte] * rows[byte];
      queries.rows[byte] = static_cast<std::int8_t>(rows[byte] - 128);
    }
    queries.squared[q] = squared;
  }
  return queries;
}

void FindNearestTwo(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out) {
  static const bool has_vnni = HasVnni();
  if (has_vnni) {
    FindNearestTwoVnni(queries, set, out);
  } else {
    FindNearestTwoSimd(queries, set, out);
  }
}

void FindNearestK(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k, std::span<Neighbour> out) {
  static const bool has_vnni = HasVnni();
  if (has_vnni) {
    FindNearestKVnni(queries, set, k, out);
  } else {
    FindNearestKSimd(queries, set, k, out);
  }
}

void FindShortNearest(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                      std::span<const BlockRange> ranges, std::span<std::uint32_t> out) {
  static const bool has_vnni = HasVnni();
  if (has_vnni) {
    FindShortNearestVnni(queries, set, k, ranges, out);
  } else {
    FindShortNearestSimd(queries, set, k, ranges, out);
  }
}

}  // namespace victorious::kernels
