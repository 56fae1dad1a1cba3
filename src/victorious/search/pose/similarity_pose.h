// pose/, in: the matches that passed the grammar. Out: for each instance a planar fit: a similarity by MLESAC (Torr and
// Zisserman 2000; thesis, section 3.3.3) and, if the matches support it, an affine map or a homography for the outline
// (plane_refinement.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

// Chosen, not fitted; shared by EstimatePoses and VotePoses.
/// Standard deviation of the keypoint position of a true match: in scene pixels at scale 1 or below, in template pixels
/// above.
inline constexpr double kKeypointNoise_px = 1.5;
/// Standard deviation of the model error of a similarity for an object seen from another side, as a fraction of the
/// object's size (square root of its outline's area).
inline constexpr double kShapeFraction = 0.04;
/// Maximum number of MLESAC samples; few matches are sampled exhaustively.
inline constexpr int kMaxPoseHypotheses = 300;
/// MLESAC stops when the probability of having missed a better sample is at most 1 minus this.
inline constexpr double kPoseConfidence = 0.999;

struct PoseOptions {
  int min_inliers = 4;
  int max_instances = 8;

  // Not user parameters from here on: the preset `thesis` and the tests set them.
  bool refine_plane = true;  ///< use an affine map or a homography for the outline if the matches support it
  std::uint64_t seed = 1;    ///< of MLESAC: equal seeds give equal results

  void ListFields(FieldList& fields);
};

/// Sequential MLESAC: fits one instance, removes its inliers and repeats until fewer than min_inliers inliers remain or
/// max_instances are found. Deterministic for a given options.seed.
/// @param outline          of the object in the template, px
/// @param scene_area_px2   area of the uniform outlier distribution
/// @param points_in_model  the surface point of each template keypoint; empty: unknown
/// @return by falling number of distinct inliers; empty if there is no instance (not an error)
std::vector<PlanarFit> EstimatePoses(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                                     const MatchSet& matches, const Polygon& outline, double scene_area_px2,
                                     const PoseOptions& options, std::span<const Point3> points_in_model = {});

/// The matches that are inliers of the fit, in their order.
/// @param matches  each scene keypoint at most once (MatchFeatures)
MatchSet SelectInliers(const MatchSet& matches, const PlanarFit& fit);

}  // namespace victorious
