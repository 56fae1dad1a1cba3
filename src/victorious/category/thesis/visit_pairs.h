// Enumerates the pairs of neighbouring keypoints.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "victorious/types/feature_set.h"

namespace victorious {

/// Calls `visit(i, j)`, i < j, for each pair of keypoints at a distance of at most `radius_px`. Coincident keypoints
/// are skipped: they define no connecting line. Cost: linear in the number of pairs whose y differs by at most the
/// radius.
template <typename Visit>
void VisitPairs(std::span<const Keypoint> keypoints, double radius_px, const Visit& visit) {
  // Sorted by y: the candidates of a keypoint follow it until dy exceeds the radius.
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
