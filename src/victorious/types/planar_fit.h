// The planar fit of a template to one instance in a scene: a similarity, a refined plane map and their inliers. Made by
// pose/, read by detect/.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/similarity.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct PlanarFit {
  Similarity2 scene_from_template;  ///< the MLESAC estimate
  /// Template pixels to scene pixels: the similarity, affine map or homography of the best BIC (plane_refinement.h).
  Eigen::Matrix3d scene_from_template_plane = Eigen::Matrix3d::Identity();
  /// The inliers of the similarity. For a relit or a pooled template their template keypoint indices refer to that
  /// template's keypoints, not to those of the stored view.
  MatchSet inliers;
  /// The surface points of the inliers, model frame, m, one each; empty for a model without depth.
  std::vector<Point3> inlier_points;
  std::size_t distinct_inliers = 0;  ///< number of different template keypoints among the inliers
  /// Residuals of the inliers that agree with the similarity also in rotation and scale
  /// (geometry/robust/similarity_estimator.h); px, ascending. Filled if the -log10 NFA below is not set.
  std::vector<double> agreeing_residuals_px;
  double extent = 0;  ///< area of the inliers' convex hull over the outline's area, in the template
  /// -log10 NFA for one searched view, decades; set if the estimator computes it itself (pose/vote_poses.h).
  std::optional<double> neg_log10_nfa;
  double sigma_px = 0;  ///< assumed standard deviation of an inlier's residual under the similarity
};

}  // namespace victorious
