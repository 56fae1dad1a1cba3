// One decoded image, of a video or a single file, with its presentation time.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace victorious {

struct Frame {
  std::int64_t index = 0;  ///< from 0, in order of presentation
  double time_s = 0.0;     ///< presentation time, seconds since the video's first frame
  cv::Mat image;           ///< CV_8UC1 (grey) or CV_8UC3 (BGR); upright, square pixels, whatever the container stores
};

}  // namespace victorious
