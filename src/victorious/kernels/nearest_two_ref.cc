// The definition of FindNearestTwo: one byte at a time.
#include "victorious/kernels/nearest_two.h"

namespace victorious::kernels {
namespace {

int PackedByte(const PackedDescriptors& set, std::size_t descriptor, std::size_t byte) {
  const std::size_t block = descriptor / kBlockDescriptors;
  const std::size_t lane = descriptor % kBlockDescriptors;
  return set.blocks[block * kBlockBytes + (byte / 4) * (4 * kBlockDescriptors) + lane * 4 + byte % 4];
}

}  // namespace

void FindNearestTwoRef(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out) {
  for (std::size_t q = 0; q < queries.count; ++q) {
    NearestTwo nearest;
    for (std::size_t i = 0; i < set.count; ++i) {
      std::uint32_t distance2 = 0;
      for (std::size_t byte = 0; byte < kDescriptorBytes; ++byte) {
        const int difference = queries.rows[q * kDescriptorBytes + byte] + 128 - PackedByte(set, i, byte);
        distance2 += static_cast<std::uint32_t>(difference * difference);
      }
      if (distance2 < nearest.best_distance2) {
        nearest.second_distance2 = nearest.best_distance2;
        nearest.best_distance2 = distance2;
        nearest.best_index = static_cast<std::uint32_t>(i);
      } else if (distance2 < nearest.second_distance2) {
        nearest.second_distance2 = distance2;
      }
    }
    out[q] = nearest;
  }
}

}  // namespace victorious::kernels
