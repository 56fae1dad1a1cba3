// One decoded image, of a video or a single file, with its presentation time.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace victorious {

/// Presentation times that differ by less are those of one frame: they are equal but for their rounding.
inline constexpr double kSameTime_s = 1e-6;

struct Frame {
  std::int64_t index = 0;  ///< from 0, in order of presentation
  double time_s = 0.0;     ///< presentation time, seconds since the video's first frame
  cv::Mat image;           ///< CV_8UC1 (grey) or CV_8UC3 (BGR); upright, square pixels, whatever the container stores
  cv::Mat bgr = {};        ///< the same in colour (CV_8UC3, BGR), where it is asked for beside a grey image; else empty
};

}  // namespace victorious
