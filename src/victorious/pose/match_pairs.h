// pose/, shared by EstimatePoses and VotePoses: matches as point pairs, and the fraction of the object they cover.
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

/// Template point (source) and scene point (target) of each match, px, in the order of the matches.
/// @param matches  a range of Match or RankedMatch
template <typename Matches>
std::vector<PointPair> MakePointPairs(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                      const Matches& matches) {
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const auto& match : matches) {
    const Keypoint& s = scene[match.scene_keypoint];
    const Keypoint& m = model[match.template_keypoint];
    pairs.push_back({{m.x, m.y}, {s.x, s.y}});
  }
  return pairs;
}

/// Area of the inliers' convex hull over the outline's area, in the template; 0 to about 1.
inline double Extent(const std::vector<PointPair>& inliers, const Polygon& outline) {
  std::vector<Eigen::Vector2d> places;
  places.reserve(inliers.size());
  for (const PointPair& pair : inliers) places.push_back(pair.source);
  return std::abs(SignedArea(ConvexHull(std::move(places)))) / std::max(1e-9, std::abs(SignedArea(outline)));
}

}  // namespace victorious
