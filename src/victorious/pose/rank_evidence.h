// How unlikely chance is as the cause of a pose whose inliers are known by rank. The formula stands in vote_poses.h.
#pragma once

#include <span>
#include <vector>

#include "victorious/pose/vote_poses.h"

namespace victorious {

/// How far from where a pose puts it an inlier may lie.
struct PoseWindow {
  double radius_px = 0;
  double widest_px = 0;  ///< the largest radius that was tried: over it keypoints are counted
};

/// @param inliers  of the pose, each template keypoint once
/// @param size_px  of the object in the template: the square root of its outline's area
/// @return decades, for one view searched; negative where chance explains the pose
double RankEvidence(const Similarity2& scene_from_template, std::span<const RankedMatch> inliers,
                    const PoseWindow& window, double size_px, const FeatureSet& scene, std::span<const Keypoint> model,
                    const VoteOptions& options);

}  // namespace victorious
