// Correspondences between a scene's keypoints and one template's.
#pragma once

#include <cstdint>
#include <vector>

namespace victorious {

/// Scene keypoint `scene` looks like template keypoint `model`. A template keypoint may serve several scene keypoints
/// (several instances can be in view); a scene keypoint matches at most one keypoint of a template.
struct Match {
  std::uint32_t scene = 0;  ///< index into the scene's keypoints
  std::uint32_t model = 0;  ///< index into the template's keypoints
  float ratio = 0;          ///< distance to it over the distance to the second nearest of the same template, < 1

  bool operator==(const Match&) const = default;
};

using MatchSet = std::vector<Match>;

/// A candidate before any test: of all the scene's keypoints, `scene` is the rank-th likest to template keypoint
/// `model`.
struct RankedMatch {
  std::uint32_t scene = 0;  ///< index into the scene's keypoints
  std::uint32_t model = 0;  ///< index into the template's keypoints
  std::uint32_t rank = 1;   ///< from 1

  bool operator==(const RankedMatch&) const = default;
};

}  // namespace victorious
