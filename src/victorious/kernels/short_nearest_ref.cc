// The reference implementations of FindShortNearest and ComputeHalfDistances: one byte at a time.
#include <algorithm>
#include <utility>
#include <vector>

#include "victorious/kernels/short_nearest.h"

namespace victorious::kernels {
namespace {

std::int32_t HalfDistance(const std::int8_t* query, const ShortSet& set, std::size_t descriptor) {
  const std::uint8_t* const lane = set.blocks.data() +
                                   descriptor / kBlockDescriptors * (kBlockDescriptors * kShortBytes) +
                                   descriptor % kBlockDescriptors * 4;
  std::int32_t product = 0;
  for (std::size_t byte = 0; byte < kShortBytes; ++byte) {
    product += query[byte] * lane[byte / 4 * (4 * kBlockDescriptors) + byte % 4];
  }
  return set.half_constant[descriptor] - product;
}

}  // namespace

void FindShortNearestRef(std::span<const std::int8_t* const> queries, const ShortSet& set, std::size_t k,
                         std::span<const QueryBlocks> blocks, std::span<std::uint32_t> out) {
  using Near = std::pair<std::int32_t, std::uint32_t>;  // half distance, number
  for (std::size_t q = 0; q < queries.size(); ++q) {
    std::vector<Near> considered;
    for (std::size_t lane = 0; lane < kBlockDescriptors; ++lane) {
      std::vector<Near> of_lane;
      for (const BlockRange& range : {blocks[q].low, blocks[q].high}) {
        for (std::size_t block = range.first; block < range.last; ++block) {
          const std::size_t i = block * kBlockDescriptors + lane;
          if (i < set.count) of_lane.emplace_back(HalfDistance(queries[q], set, i), static_cast<std::uint32_t>(i));
        }
      }
      std::ranges::sort(of_lane);
      of_lane.resize(std::min<std::size_t>(of_lane.size(), 2));
      considered.insert(considered.end(), of_lane.begin(), of_lane.end());
    }
    std::ranges::sort(considered);
    for (std::size_t r = 0; r < k; ++r) out[q * k + r] = r < considered.size() ? considered[r].second : kNoNeighbour;
  }
}

void ComputeHalfDistancesRef(std::span<const std::int8_t> query, const ShortSet& set, std::span<std::int32_t> out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = HalfDistance(query.data(), set, i);
}

}  // namespace victorious::kernels
