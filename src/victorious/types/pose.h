// Where one instance of a template lies in a scene.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/similarity.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct Pose {
  Similarity2 scene_from_template;  ///< MLESAC's
  /// The similarity, or the affine map or homography that explains the matches better; template pixels to scene pixels.
  Eigen::Matrix3d scene_from_template_plane = Eigen::Matrix3d::Identity();
  /// The matches that obey the similarity. Where a view was compared under the sun, or together with those beside it,
  /// their `model` counts the keypoints of what was compared.
  MatchSet inliers;
  /// The inliers' places on the object, metres, one each; empty where the model has no depth.
  std::vector<Point3> inlier_points;
  std::size_t distinct_inliers = 0;  ///< different template keypoints among them
  /// How far those of them lie from where the similarity puts them that agree with it in turn and scale, too
  /// (geometry/robust/similarity_estimator.h); px, ascending. Known where `evidence` is none.
  std::vector<double> agreeing_px;
  double extent = 0;  ///< area of the inliers' hull over the outline's, in the template
  /// Where the stage that found the pose knows it: decades by which chance is too unlikely, one view searched.
  std::optional<double> evidence;
  double sigma_px = 0;  ///< the deviation of an inlier from the similarity's place, as assumed
};

}  // namespace victorious
