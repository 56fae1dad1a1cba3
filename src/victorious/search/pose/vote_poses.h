// pose/, Hough voting. In: ranked matches with a low inlier ratio. Out: planar fits with their -log10 NFA.
//
// Method. Each match determines a similarity, because keypoints have scale and orientation; it votes for the object's
// centre, scale and rotation. True matches agree (Lowe 2004, section 7.3; here with a window around each vote instead
// of bins). The votes with the highest Poisson log-likelihood ratio over the expected chance count are seeds. For each
// seed MLESAC fits a similarity to its voters, and all ranked matches that agree with it become inliers.
//
// Significance, a contrario (Desolneux, Moisan and Morel; as in search/detect/detect.h), with the rank r of each inlier
// in its template keypoint's list. Under the background model descriptors are uninformative, and an inlier of rank r
// occurs with the chance
//   p = r * (scene keypoints that agree with the pose in position, rotation and scale) / (scene keypoints).
// With n visible template keypoints, the k-th smallest chance p_k and T distinguishable poses in the scene,
//   -log10 NFA = max over k of -log10(T C(n, k) p_k^k) - kDependenceDecades,
// and -log10(T) - kDependenceDecades for k = 0; the maximum over three window widths (1, 1/2, 1/4).
// Of inliers that overlap in the scene, and see the same pixels, only the one of lowest rank counts; likewise of
// inliers with similar descriptors. n includes every inlier, also one that projects just outside the frame or is just
// below the minimum scale. A prior on the upright pose (upright_prior.h) discards votes for overturned objects and
// reduces T. docs/adr/0008 has the measurements.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/geometry/polygon.h"
#include "victorious/search/pose/similarity_pose.h"
#include "victorious/search/pose/upright_prior.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

// Chosen on dev_straight and dev_soft (docs/adr/0008 has the measurements).
/// Votes for one pose agree on the object's centre within this fraction of its length: the effect of keypoint scale and
/// orientation errors on the centre.
inline constexpr double kCentreFraction = 0.2;
/// Votes for one pose, and its inliers, agree in scale within this factor.
inline constexpr double kVoteScaleFactor = 1.5;
/// Vote clusters of one view that MLESAC fits: those of the highest likelihood ratio.
inline constexpr int kMaxSeeds = 3;
/// -log10 NFA from which a pose is an instance; its seed does not count towards kMaxSeeds, since one frame may show
/// several instances.
inline constexpr double kInstanceNegLog10Nfa = 6.0;
/// Template keypoints whose scale in the scene is smaller than this, px, count as not visible: SIFT's smallest
/// keypoints.
inline constexpr double kMinVisibleScale_px = 0.9;
/// Subtracted from the -log10 NFA, decades: the background model assumes independence, but keypoints of one texture
/// look alike.
inline constexpr double kDependenceDecades = 4.0;

/// Not user parameters: the tests vary them.
struct VoteOptions {
  double turn_rad = 0.5;  ///< votes for one pose, and its inliers, agree in rotation within this
  int min_votes = 4;      ///< minimum number of distinct template keypoints that vote for a pose
  /// Inliers nearer to each other than this times their scale depend on the same scene pixels and count once.
  double min_separation_scales = 4.0;
};

/// The poses of one template. Follows at most kMaxSeeds seeds; a seed whose pose reaches kInstanceNegLog10Nfa is an
/// instance and does not count towards this limit. Deterministic.
/// @param matches          of one template, sorted by template keypoint
/// @param outline          of the object in the template, px
/// @param upright          prior on the rotation; nullopt: every pose is allowed
/// @param points_in_model  the surface point of each template keypoint; empty: unknown
/// @return by falling -log10 NFA, set in each fit; may be empty
std::vector<PlanarFit> VotePoses(const FeatureSet& scene, std::span<const Keypoint> template_keypoints,
                                 std::span<const RankedMatch> matches, const Polygon& outline, const VoteOptions& votes,
                                 const PoseOptions& options, const std::optional<UprightPrior>& upright = {},
                                 std::span<const Point3> points_in_model = {});

}  // namespace victorious
