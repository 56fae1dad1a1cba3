// An object found in one frame.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/geometry/similarity.h"
#include "victorious/types/match_set.h"

namespace victorious {

struct Detection {
  std::size_t model = 0;            ///< index into the models that were searched
  std::size_t view = 0;             ///< index into that model's views
  Similarity2 scene_from_template;  ///< MLESAC's similarity
  Eigen::Matrix3d scene_from_template_plane =
      Eigen::Matrix3d::Identity();   ///< refined: affine or homography where supported
  Polygon outline;                   ///< of the object in the scene, px; may leave the frame
  Box box;                           ///< of the outline clipped to the frame, px
  double score = 0;                  ///< 0 to 1, higher is likelier
  MatchSet inliers;                  ///< matches that obey the pose
  std::size_t distinct_inliers = 0;  ///< different template keypoints among them
};

}  // namespace victorious
