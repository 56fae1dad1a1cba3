// track/, how the picture as a whole moved from one frame to the next, so that an object need not be sought where the
// camera has left it behind.
#pragma once

#include <optional>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/similarity.h"
#include "victorious/track/flow.h"

namespace victorious {

class CameraMotion {
 public:
  /// @param grey  CV_8UC1, the next frame
  /// @return now_from_before, px; nothing where it cannot be told (first frame, a cut, too little to follow)
  std::optional<Similarity2> Step(const cv::Mat& grey);

 private:
  std::optional<FlowPyramid> before_;  // of a smaller picture
};

}  // namespace victorious
