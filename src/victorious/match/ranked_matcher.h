// match/, the other way round: each template keypoint with the few scene keypoints that look most like it, without a
// test. Where the scene is cluttered and the object has little texture, a template keypoint's true partner is often
// among its nearest few of thousands, though no ratio test lets it through; which of them are true is for votes
// (pose/vote_poses.h) to find. docs/adr/0008 has the figures.
#pragma once

#include <vector>

#include "victorious/kernels/nearest.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// A scene made ready once, then compared with any number of templates by any number of threads.
class RankedMatcher {
 public:
  explicit RankedMatcher(const FeatureView& scene) : scene_(kernels::Pack(scene.descriptors)) {}

  /// @param model    a template's descriptors
  /// @param nearest  how many scene keypoints for each of the template's, 1 to kernels::kMostNeighbours
  /// @return in the order of the template's keypoints, then of rank; none if the scene has no more than `nearest`
  /// Cost: that of MatchFeatures().
  [[nodiscard]] std::vector<RankedMatch> Match(const kernels::PackedQueries& model, int nearest) const;

 private:
  kernels::PackedDescriptors scene_;
};

}  // namespace victorious
