// Correspondences between the keypoints of a scene and of one template.
#pragma once

#include <cstdint>
#include <vector>

namespace victorious {

/// A match that passes the ratio test. A template keypoint may match several scene keypoints (several instances can be
/// in view); a scene keypoint matches at most one keypoint of a template.
struct Match {
  std::uint32_t scene_keypoint = 0;     ///< index into the scene's keypoints
  std::uint32_t template_keypoint = 0;  ///< index into the template's keypoints
  float ratio = 0;  ///< distance to it over the distance to the second nearest of the same template, < 1

  bool operator==(const Match&) const = default;
};

using MatchSet = std::vector<Match>;

/// A match without a ratio test: the scene keypoint whose descriptor is the rank-th nearest to the template keypoint's
/// among all scene keypoints.
struct RankedMatch {
  std::uint32_t scene_keypoint = 0;     ///< index into the scene's keypoints
  std::uint32_t template_keypoint = 0;  ///< index into the template's keypoints
  std::uint32_t rank = 1;               ///< from 1, the nearest

  bool operator==(const RankedMatch&) const = default;
};

}  // namespace victorious
