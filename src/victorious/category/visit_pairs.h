// The pairs of keypoints that lie near each other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "victorious/types/feature_set.h"

namespace victorious {

/// Calls `visit(i, j)`, i < j, for each pair of keypoints no farther apart than `radius_px`, two at one place excepted:
/// no line connects them. Cost: the pairs of keypoints whose heights differ by less than the radius.
template <typename Visit>
void VisitPairs(std::span<const Keypoint> keypoints, double radius_px, const Visit& visit) {
  // By rising y: the partners of a keypoint follow it until they lie too far down.
  std::vector<std::uint32_t> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(keypoints[i].y, i); });
  const auto radius = static_cast<float>(radius_px);
  for (std::size_t a = 0; a < order.size(); ++a) {
    const Keypoint& first = keypoints[order[a]];
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      const Keypoint& second = keypoints[order[b]];
      const float dy = second.y - first.y;
      if (dy > radius) break;
      const float dx = second.x - first.x;
      const float distance2 = dx * dx + dy * dy;
      if (distance2 > radius * radius || distance2 == 0) continue;
      visit(std::min(order[a], order[b]), std::max(order[a], order[b]));
    }
  }
}

}  // namespace victorious
