// The reference implementations of FindNearestTwo and FindNearestK: one byte at a time.
#include <algorithm>
#include <vector>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {
namespace {

int PackedByte(const PackedDescriptors& set, std::size_t descriptor, std::size_t byte) {
  const std::size_t block = descriptor / kBlockDescriptors;
  const std::size_t lane = descriptor % kBlockDescriptors;
  return set.blocks[block * kBlockBytes + (byte / 4) * (4 * kBlockDescriptors) + lane * 4 + byte % 4];
}

std::uint32_t Distance2(const PackedQueries& queries, std::size_t query, const PackedDescriptors& set,
                        std::size_t descriptor) {
  std::uint32_t distance2 = 0;
  for (std::size_t byte = 0; byte < kDescriptorBytes; ++byte) {
    const int difference = queries.rows[query * kDescriptorBytes + byte] + 128 - PackedByte(set, descriptor, byte);
    distance2 += static_cast<std::uint32_t>(difference * difference);
  }
  return distance2;
}

}  // namespace

void FindNearestTwoRef(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out) {
  for (std::size_t q = 0; q < queries.count; ++q) {
    NearestTwo nearest;
    for (std::size_t i = 0; i < set.count; ++i) {
      const std::uint32_t distance2 = Distance2(queries, q, set, i);
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

void FindNearestKRef(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                     std::span<Neighbour> out) {
  for (std::size_t q = 0; q < queries.count; ++q) {
    std::vector<Neighbour> all;
    for (std::size_t i = 0; i < set.count; ++i)
      all.push_back({static_cast<std::uint32_t>(i), Distance2(queries, q, set, i)});
    std::ranges::stable_sort(all, {}, &Neighbour::distance2);
    for (std::size_t r = 0; r < k; ++r) out[q * k + r] = r < all.size() ? all[r] : Neighbour{};
  }
}

}  // namespace victorious::kernels
