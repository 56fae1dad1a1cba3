// A picture out of a video (or alone), with its place in time.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace victorious {

struct Frame {
  std::int64_t index = 0;  ///< from 0, in order of presentation
  double time_s = 0.0;     ///< presentation time, seconds since the video's first frame
  cv::Mat image;           ///< 8-bit, upright, of square pixels, however stored: CV_8UC1 (grey) or CV_8UC3 (BGR)
};

}  // namespace victorious
