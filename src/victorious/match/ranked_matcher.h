// match/, from template to scene: for each template keypoint the k nearest scene keypoints, without a ratio test. For
// objects of little texture in cluttered scenes the true match is often among the k nearest of thousands but fails the
// ratio test. The vote search (pose/vote_poses.h) finds the true ones. Measurements: docs/adr/0008.
#pragma once

#include <vector>

#include "victorious/kernels/nearest.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// A scene with packed descriptors, matched with any number of templates. Thread-safe.
class RankedMatcher {
 public:
  explicit RankedMatcher(const FeatureView& scene) : scene_(kernels::Pack(scene.descriptors)) {}

  /// @param model    a template's descriptors
  /// @param nearest  k, the number of scene keypoints per template keypoint, 1 to kernels::kMaxNeighbours
  /// @return sorted by template keypoint, then by rank; empty if the scene has no more than `nearest` keypoints
  /// Cost: that of MatchFeatures().
  [[nodiscard]] std::vector<RankedMatch> Match(const kernels::PackedQueries& model, int nearest) const;

 private:
  kernels::PackedDescriptors scene_;
};

}  // namespace victorious
