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

struct PoseOptions {
  double noise_px = 1.5;
  double shape_fraction = 0.04;
  int min_inliers = 4;
  int max_instances = 8;
  int max_hypotheses = 300;
  double confidence = 0.999;
  bool refine_plane = true;
  std::uint64_t seed = 1;

  void ListFields(FieldList& fields);
};

/// Sequential MLESAC: fits one instance, removes its inliers and repeats until fewer than min_inliers inliers remain or
/// max_instances are found. Deterministic for a given options.seed.
/// @param outline         of the object in the template, px
/// @param scene_area_px2  area of the uniform outlier distribution
/// @return by falling number of distinct inliers; empty if there is no instance (not an error)
std::vector<PlanarFit> EstimatePoses(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                                     const MatchSet& matches, const Polygon& outline, double scene_area_px2,
                                     const PoseOptions& options);

}  // namespace victorious
