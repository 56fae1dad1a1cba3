// Random sampling without replacement.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "victorious/base/random.h"

namespace victorious {

/// Draws min(max_count, count) distinct indices below `count`, in random order (the first steps of a Fisher-Yates
/// shuffle).
/// @pre count < 2^32
inline std::vector<std::uint32_t> SampleIndices(std::size_t count, std::size_t max_count, Random& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  const std::size_t drawn = std::min(max_count, count);
  for (std::size_t i = 0; i < drawn; ++i)
    std::swap(order[i], order[i + random.Below(static_cast<std::uint32_t>(count - i))]);
  order.resize(drawn);
  return order;
}

}  // namespace victorious
