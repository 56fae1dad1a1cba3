// pose/, by votes: ranked matches, of which few are true, in; poses out. Each match alone fixes a similarity, because
// keypoints have a size and a direction; true ones agree on the object's place, scale and turn (Lowe 2004, section 7.3,
// with windows about each vote instead of bins). Where votes agree more than chance lets them, MLESAC finds what they
// agree on, and every match near it is gathered.
//
// The evidence of a pose is a-contrario, as in detect/detect.h, but knows how far down its template keypoint's list of
// likest scene keypoints an inlier stands. Were descriptors to say nothing, an inlier of rank r would be there with the
// chance p = r * (scene keypoints that lie, and are turned and sized, as the pose demands) / (scene keypoints). With n
// template keypoints that the scene could show, the k-th smallest chance p_k and T poses that differ in the scene,
//   evidence = max over k of -log10(T C(n, k) p_k^k) - dependence_decades,
// at most -log10(T) - dependence_decades where chance explains it all; the largest over three widths of the windows.
// Inliers that overlap each other in the scene see the same pixels: of those only the best counts. n holds every
// inlier, also one that the pose puts just out of the frame or makes just too small. Where the camera's attitude is
// known, votes for poses that would tip the object over do not count, and T is so much smaller.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/geometry/polygon.h"
#include "victorious/pose/similarity_pose.h"
#include "victorious/pose/upright.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/pose.h"

namespace victorious {

struct VoteOptions {
  double place_share = 0.2;
  double scale_factor = 1.5;
  double turn_rad = 0.5;
  int most_seeds = 3;
  double another_evidence = 6.0;
  int least_votes = 4;
  double apart = 4.0;
  double least_scale_px = 0.9;
  double dependence_decades = 4.0;

  void ListFields(FieldList& fields);
};

/// At most votes.most_seeds poses, and one more for each that is an instance beyond doubt (votes.another_evidence),
/// each with its evidence, most of it first. Deterministic.
/// @param matches  of one template, by template keypoint
/// @param outline  of the object in the template, px
/// @param upright  what the camera's attitude allows of the template; nothing: every pose
std::vector<Pose> VotePoses(const FeatureSet& scene, std::span<const Keypoint> model,
                            std::span<const RankedMatch> matches, const Polygon& outline, const VoteOptions& votes,
                            const PoseOptions& options, const std::optional<UprightPrior>& upright = {});

}  // namespace victorious
