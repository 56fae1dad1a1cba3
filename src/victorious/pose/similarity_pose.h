// pose/, in: the matches that survived the grammar. Out: where the template lies in the scene: for each instance a
// similarity by MLESAC (thesis, section 3.3.3) and, where the matches support it, the plane's affine map or homography
// that brings the outline to where it is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/pose.h"

namespace victorious {

struct PoseOptions {
  double noise_px = 1.5;
  double shape_fraction = 0.04;
  int least_inliers = 4;
  int max_instances = 8;
  int max_hypotheses = 300;
  double confidence = 0.999;
  bool refine_plane = true;
  std::uint64_t seed = 1;

  void ListFields(FieldList& fields);
};

/// Every instance, the best supported first: MLESAC, its inliers taken out, MLESAC again, until fewer than
/// least_inliers distinct ones agree. No instance is a result, not an error. Deterministic by options.seed.
/// @param outline        of the object in the template, px
/// @param scene_area_px2 over which a wrong match may lie
std::vector<Pose> EstimatePoses(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                const MatchSet& matches, const Polygon& outline, double scene_area_px2,
                                const PoseOptions& options);

}  // namespace victorious
