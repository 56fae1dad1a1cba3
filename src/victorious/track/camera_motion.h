// track/: the global image motion between consecutive frames, to predict where an object goes.
//
// Method: up to 80 corners of the frame, scaled to at most 400 px on its long side, are tracked by Lucas-Kanade
// (flow.h); MLESAC fits a similarity (corner_motion.h).
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/similarity.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/track/flow.h"

namespace victorious {

class ImageMotionEstimator {
 public:
  /// @param grey  CV_8UC1, the next frame
  /// @return now_from_before, px of the full frame; std::nullopt for the first frame, after a change of size, with
  ///   fewer than 12 inliers (a cut, no texture) or with a scale change of 1.5 or more
  std::optional<Similarity2> Step(const cv::Mat& grey);

  /// The corners that the last Step tracked, px of the full frame. Some are wrong.
  [[nodiscard]] const std::vector<PointPair>& corners() const { return corners_; }

 private:
  std::optional<FlowPyramid> before_;  // of the scaled-down previous frame
  std::vector<PointPair> corners_;
};

}  // namespace victorious
