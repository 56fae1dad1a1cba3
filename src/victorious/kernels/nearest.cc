#include "victorious/kernels/nearest.h"

#include "victorious/kernels/k_nearest.h"

namespace victorious::kernels {

PackedDescriptors Pack(std::span<const std::uint8_t> rows) {
  PackedDescriptors set;
  set.count = rows.size() / kDescriptorBytes;
  const std::size_t blocks = (set.count + kBlockDescriptors - 1) / kBlockDescriptors;
  set.blocks.assign(blocks * kBlockBytes, 0);
  set.constant.assign(blocks * kBlockDescriptors, kPaddingDistance);
  for (std::size_t i = 0; i < set.count; ++i) {
    const std::uint8_t* row = rows.data() + i * kDescriptorBytes;
    std::int32_t squared = 0;
    std::int32_t sum = 0;
    for (std::size_t byte = 0; byte < kDescriptorBytes; ++byte) {
      squared += row[byte] * row[byte];
      sum += row[byte];
    }
    InterleaveRow({row, kDescriptorBytes}, i, set.blocks.data());
    set.constant[i] = squared - 256 * sum;
  }
  return set;
}

PackedQueries PackQueries(std::span<const std::uint8_t> rows) {
  PackedQueries queries;
  queries.count = rows.size() / kDescriptorBytes;
  queries.rows.resize(queries.count * kDescriptorBytes);
  queries.squared.resize(queries.count);
  for (std::size_t q = 0; q < queries.count; ++q) {
    std::int32_t squared = 0;
    for (std::size_t byte = q * kDescriptorBytes; byte < (q + 1) * kDescriptorBytes; ++byte) {
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

}  // namespace victorious::kernels
