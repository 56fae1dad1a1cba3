// pose/, for VotePoses: the -log10 NFA (a contrario) of a similarity from the ranks of its inliers. The formula is
// in vote_poses.h.
#pragma once

#include <span>
#include <vector>

#include "victorious/search/pose/vote_poses.h"

namespace victorious {

/// The inlier radius in the scene.
struct PoseWindow {
  double radius_px = 0;  ///< largest residual of an inlier
  double widest_px = 0;  ///< the largest radius that was tried; twice this radius counts the scene keypoints
};

/// log10 of the number T of distinguishable poses: positions one window apart, times rotations (full circle) and scales
/// (four octaves) that move the object's rim by one window.
/// @param size_px  as below
double Log10PoseCount(const Similarity2& scene_from_template, double radius_px, double size_px,
                      const FeatureSet& scene);

/// @param inliers  of the similarity, each template keypoint once
/// @param size_px  size of the object in the template: square root of the outline's area
/// @return -log10 NFA, decades, for one searched view; negative if chance explains the pose
/// Cost: scene keypoints + inliers x scene keypoints around the object.
double ComputeRankNegLog10Nfa(const Similarity2& scene_from_template, std::span<const RankedMatch> inliers,
                              const PoseWindow& window, double size_px, const FeatureSet& scene,
                              std::span<const Keypoint> template_keypoints, const VoteOptions& options);

}  // namespace victorious
