// An object found in one frame. Made by detect/ and rescored by recognize/.
#pragma once

#include <cstddef>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

/// What a detection rests on.
enum class DetectionCue {
  kKeypoints,  ///< matches of keypoints
  kShape,      ///< edges (search/recognize/shape_search.h); the inliers of its fit are points to track, not matches
};

struct Detection {
  std::size_t model_index = 0;  ///< index into the models that were searched; not a keypoint index, not a database id
  std::size_t view = 0;         ///< index into that model's views
  PlanarFit fit;
  Polygon outline;           ///< the object's outline in the scene, px; may leave the frame
  Box box;                   ///< bounding box of the outline clipped to the frame, px
  double neg_log10_nfa = 0;  ///< -log10 NFA, decades (search/detect/detect.h)
  DetectionCue cue = DetectionCue::kKeypoints;
  double score = 0;  ///< 0 to 1, higher is likelier
};

}  // namespace victorious
