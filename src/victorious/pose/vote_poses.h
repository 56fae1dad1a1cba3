// pose/, Hough voting. In: ranked matches with a low inlier ratio. Out: planar fits with their -log10 NFA.
//
// Method. Each match determines a similarity, because keypoints have scale and orientation; it votes for the object's
// centre, scale and rotation. True matches agree (Lowe 2004, section 7.3; here with a window around each vote instead
// of bins). The votes with the highest Poisson log-likelihood ratio over the expected chance count are seeds. For each
// seed MLESAC fits a similarity to its voters, and all ranked matches that agree with it become inliers.
//
// Significance, a contrario (Desolneux, Moisan and Morel; as in detect/detect.h), with the rank r of each inlier in its
// template keypoint's list. Under the background model descriptors are uninformative, and an inlier of rank r occurs
// with the chance
//   p = r * (scene keypoints that agree with the pose in position, rotation and scale) / (scene keypoints).
// With n visible template keypoints, the k-th smallest chance p_k and T distinguishable poses in the scene,
//   -log10 NFA = max over k of -log10(T C(n, k) p_k^k) - dependence_decades,
// and -log10(T) - dependence_decades for k = 0; the maximum over three window widths (1, 1/2, 1/4).
// Of inliers that overlap in the scene, and see the same pixels, only the one of lowest rank counts; likewise of
// inliers with similar descriptors. n includes every inlier, also one that projects just outside the frame or is just
// below the minimum scale. A prior on the upright pose (upright_prior.h) discards votes for overturned objects and
// reduces T. docs/adr/0008 has the measurements.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/geometry/polygon.h"
#include "victorious/pose/similarity_pose.h"
#include "victorious/pose/upright_prior.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

struct VoteOptions {
  double centre_fraction = 0.2;
  double scale_factor = 1.5;
  double turn_rad = 0.5;
  int max_seeds = 3;
  double instance_neg_log10_nfa = 6.0;
  int min_votes = 4;
  double min_separation_scales = 4.0;
  double min_scale_px = 0.9;
  double dependence_decades = 4.0;

  void ListFields(FieldList& fields);
};

/// The poses of one template. Follows at most votes.max_seeds seeds; a seed whose pose reaches
/// votes.instance_neg_log10_nfa is an instance and does not count towards this limit. Deterministic.
/// @param matches  of one template, sorted by template keypoint
/// @param outline  of the object in the template, px
/// @param upright  prior on the rotation; nullopt: every pose is allowed
/// @return by falling -log10 NFA, set in each fit; may be empty
std::vector<PlanarFit> VotePoses(const FeatureSet& scene, std::span<const Keypoint> template_keypoints,
                                 std::span<const RankedMatch> matches, const Polygon& outline, const VoteOptions& votes,
                                 const PoseOptions& options, const std::optional<UprightPrior>& upright = {});

}  // namespace victorious
