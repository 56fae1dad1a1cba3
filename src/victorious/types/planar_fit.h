// The planar fit of a template to one instance in a scene: a similarity, a refined plane map and their inliers. Made by
// pose/, read by detect/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/similarity.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// An inlier of a fit, with its template keypoint by value: it means the same whichever template was matched, a stored
/// view, a relit or a pooled template.
struct FitInlier {
  std::uint32_t scene_keypoint = 0;      ///< index into the scene's keypoints
  Keypoint keypoint_in_template;         ///< in pixels of the view
  std::optional<Point3> point_in_model;  ///< its surface point, model frame, m; nullopt for a model without depth
};

struct PlanarFit {
  Similarity2 scene_from_template;  ///< the MLESAC estimate
  /// Template pixels to scene pixels: the similarity, affine map or homography of the best BIC (plane_refinement.h).
  Eigen::Matrix3d scene_from_template_plane = Eigen::Matrix3d::Identity();
  std::vector<FitInlier> inliers;    ///< of the similarity
  std::size_t distinct_inliers = 0;  ///< number of different template keypoints among the inliers
  /// Residuals of the inliers that agree with the similarity also in rotation and scale
  /// (geometry/robust/similarity_estimator.h); px, ascending. Filled if the -log10 NFA below is not set.
  std::vector<double> agreeing_residuals_px;
  double extent = 0;  ///< area of the inliers' convex hull over the outline's area, in the template
  /// -log10 NFA for one searched view, decades; set if the estimator computes it itself (search/pose/vote_poses.h).
  std::optional<double> neg_log10_nfa;
  double sigma_px = 0;  ///< assumed standard deviation of an inlier's residual under the similarity
};

}  // namespace victorious
