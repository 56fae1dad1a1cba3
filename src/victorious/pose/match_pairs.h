// What the ways from matches to poses share: matches as point pairs, and how much of the object they speak for.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "victorious/geometry/polygon.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// @param matches  Match or RankedMatch, in their order
template <typename Matches>
std::vector<PointPair> PairsOf(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                               const Matches& matches) {
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const auto& match : matches) {
    const Keypoint& s = scene[match.scene];
    const Keypoint& m = model[match.model];
    pairs.push_back({{m.x, m.y}, {s.x, s.y}});
  }
  return pairs;
}

/// The share of the object that the inliers speak for: their hull's area over the outline's, in the template.
inline double Extent(const std::vector<PointPair>& inliers, const Polygon& outline) {
  std::vector<Eigen::Vector2d> places;
  places.reserve(inliers.size());
  for (const PointPair& pair : inliers) places.push_back(pair.source);
  return std::abs(SignedArea(ConvexHull(std::move(places)))) / std::max(1e-9, std::abs(SignedArea(outline)));
}

}  // namespace victorious
