// pose/, before VotePoses: proposes the most significant pose of a template's ranked matches, with an approximate
// -log10 NFA, for a fraction of the cost. Ranks templates, so that only the best are matched and fitted in full.
//
// Votes are accumulated as in vote_poses.h. The votes of the highest Poisson log-likelihood ratios are seeds. A match
// determines a similarity, so each seed is a hypothesis by itself (no sampling); its inliers by position are refitted
// by least squares, from wide to narrow windows. For each window
//   -log10 NFA ~ max over k of -log10(T C(n, k) p_k^k) - kDependenceDecades,   p = rank * (fraction of agreeing
//   keypoints)
// as in rank_nfa.h, but with that fraction estimated from the area of the window and the density of keypoints around
// the object. Ranks are those among the keypoints of allowed orientation; NegLog10NfaOfRanks() repeats the test with
// ranks in the whole scene, which separate true proposals from chance: of chance inliers most have a rank above eight
// there. On 26 sightings of three movies the best two of about 100 templates held a neighbour of the right view
// each time; by the likelihood ratio of the votes alone, the best twenty did not (docs/adr/0018).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/polygon.h"
#include "victorious/search/pose/upright_prior.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// Where keypoints are dense, relative to the whole scene. Thread-safe.
class KeypointDensity {
 public:
  explicit KeypointDensity(const FeatureSet& scene);

  /// The density in the square around a point, over the scene's mean density; of whole cells of 16 px.
  /// @param half_side_px  of the square
  [[nodiscard]] double Around(double x, double y, double half_side_px) const;

 private:
  int columns_ = 1;
  int rows_ = 1;
  std::vector<double> sums_;  // integral image of the counts per cell, (columns_ + 1) x (rows_ + 1)
};

/// The most significant pose of a template.
struct PoseProposal {
  double neg_log10_nfa;       ///< approximate, of one template
  Eigen::Vector2d centre_px;  ///< of the outline's box, in the scene
  double size_px;             ///< square root of the outline's area, in the scene
  /// One-to-one, of the window with that NFA.
  std::vector<RankedMatch> inliers;
  double agreeing_fraction;        ///< of the scene's keypoints: that agree with the pose in position and scale
  double log10_pose_count;         ///< T
  std::size_t template_keypoints;  ///< n
};

/// @param matches       of the template, sorted by template keypoint; ranks among the keypoints of allowed orientation
/// @param outline       of the object in the template, px
/// @param max_turn_rad  half the interval of orientations that was allowed, (0, pi]
/// @param upright       prior on the rotation, checked for each seed; nullopt: every pose is allowed
/// @return std::nullopt without a pose of four independent inliers
[[nodiscard]] std::optional<PoseProposal> ProposePose(const FeatureSet& scene, const KeypointDensity& density,
                                                      std::span<const Keypoint> template_keypoints,
                                                      std::span<const RankedMatch> matches, const Polygon& outline,
                                                      double max_turn_rad,
                                                      const std::optional<UprightPrior>& upright = {});

/// The approximate -log10 NFA of a proposal whose inliers have the given ranks instead of their own.
/// @param inliers       of the proposal, some or all, with ranks among the scene keypoints within max_turn_rad
/// @param max_turn_rad  half the interval of orientations in which ranks are counted, (0, pi]
[[nodiscard]] double NegLog10NfaOfRanks(const PoseProposal& proposal, const FeatureSet& scene,
                                        std::vector<RankedMatch> inliers, double max_turn_rad);

}  // namespace victorious
