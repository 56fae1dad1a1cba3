// pose/, shared by EstimatePoses and VotePoses: matches as point pairs and as inliers of a fit, the number of template
// keypoints among them, and the fraction of the object they cover.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "victorious/geometry/polygon.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/planar_fit.h"

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

/// The same of the inliers of a fit.
inline std::vector<PointPair> MakePointPairs(std::span<const Keypoint> scene, const std::vector<FitInlier>& inliers) {
  std::vector<PointPair> pairs;
  pairs.reserve(inliers.size());
  for (const FitInlier& inlier : inliers) {
    const Keypoint& s = scene[inlier.scene_keypoint];
    const Keypoint& m = inlier.keypoint_in_template;
    pairs.push_back({{m.x, m.y}, {s.x, s.y}});
  }
  return pairs;
}

/// @param matches          a range of Match or RankedMatch
/// @param points_in_model  the surface point of each template keypoint; empty for a model without depth
template <typename Matches>
std::vector<FitInlier> MakeFitInliers(std::span<const Keypoint> template_keypoints,
                                      std::span<const Point3> points_in_model, const Matches& matches) {
  std::vector<FitInlier> inliers;
  inliers.reserve(matches.size());
  for (const auto& match : matches) {
    inliers.push_back({.scene_keypoint = match.scene_keypoint,
                       .keypoint_in_template = template_keypoints[match.template_keypoint],
                       .point_in_model = points_in_model.empty()
                                             ? std::nullopt
                                             : std::optional(points_in_model[match.template_keypoint])});
  }
  return inliers;
}

/// The number of different template keypoints among the matches.
/// @param matches  a range of Match or RankedMatch
template <typename Matches>
std::size_t CountTemplateKeypoints(const Matches& matches) {
  std::vector<std::uint32_t> keypoints;
  keypoints.reserve(matches.size());
  for (const auto& match : matches) keypoints.push_back(match.template_keypoint);
  std::ranges::sort(keypoints);
  return static_cast<std::size_t>(std::unique(keypoints.begin(), keypoints.end()) - keypoints.begin());
}

/// Area of the inliers' convex hull over the outline's area, in the template; 0 to about 1.
inline double Extent(const std::vector<PointPair>& inliers, const Polygon& outline) {
  std::vector<Eigen::Vector2d> sources;
  sources.reserve(inliers.size());
  for (const PointPair& pair : inliers) sources.push_back(pair.source);
  return std::abs(SignedArea(ConvexHull(std::move(sources)))) / std::max(1e-9, std::abs(SignedArea(outline)));
}

}  // namespace victorious
