// Shared by the vector implementations of FindNearestTwo: reduces the running results of 16 lanes to one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

/// Lane l processes the descriptors l, l + 16, l + 32, …: its smallest partial distance, the block of that minimum, and
/// its second smallest. Partial distances omit |q|^2.
struct LaneResults {
  alignas(64) std::int32_t best[kBlockDescriptors];
  alignas(64) std::int32_t second[kBlockDescriptors];
  alignas(64) std::int32_t block[kBlockDescriptors];
};

inline NearestTwo ReduceLanes(const LaneResults& lanes, std::int32_t query_squared, std::size_t set_count) {
  std::size_t winner = 0;
  for (std::size_t lane = 1; lane < kBlockDescriptors; ++lane) {
    const bool less = lanes.best[lane] < lanes.best[winner];
    const bool earlier = lanes.best[lane] == lanes.best[winner] && lanes.block[lane] < lanes.block[winner];
    if (less || earlier) winner = lane;
  }
  std::int32_t second = lanes.second[winner];
  for (std::size_t lane = 0; lane < kBlockDescriptors; ++lane) {
    if (lane != winner) second = std::min(second, lanes.best[lane]);
  }
  NearestTwo nearest;
  if (set_count > 0) {
    nearest.best_index =
        static_cast<std::uint32_t>(static_cast<std::size_t>(lanes.block[winner]) * kBlockDescriptors + winner);
    nearest.best_distance2 = static_cast<std::uint32_t>(lanes.best[winner] + query_squared);
  }
  if (set_count > 1) nearest.second_distance2 = static_cast<std::uint32_t>(second + query_squared);
  return nearest;
}

}  // namespace victorious::kernels
