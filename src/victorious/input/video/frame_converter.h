// Private to video/: converts a decoded frame of any FFmpeg pixel format to an upright 8-bit cv::Mat with square
// pixels.
//
// Grey output is read directly from the luma plane if that is BT.601 luma; limited range (16..235) is stretched to
// 0..255 and deeper samples are reduced to 8 bits in the same pass. All other formats are converted through BGR.
#pragma once

#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/input/image/grey_range.h"
#include "victorious/input/image/orientation.h"
#include "victorious/input/video/ffmpeg_handles.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {

class FrameConverter {
 public:
  /// @param size  target size before rotation, with square pixels; frames of another size are scaled to it
  FrameConverter(FrameColor color, Orientation orientation, cv::Size size)
      : color_(color), orientation_(orientation), size_(size) {}

  /// Returns the image (CV_8UC1 or CV_8UC3 BGR), which owns its pixels.
  /// Errors: kUnsupported (pixel format), kInternal (out of memory).
  [[nodiscard]] Expected<cv::Mat> Convert(const AVFrame& frame);

  /// What was done to grey frames of more than 8 bits; std::nullopt if nothing.
  [[nodiscard]] std::optional<std::string> DescribeRange() const { return range_.Describe(); }

 private:
  [[nodiscard]] Expected<cv::Mat> ConvertAndRotate(const AVFrame& frame);
  [[nodiscard]] Expected<cv::Mat> ConvertColor(const AVFrame& frame);
  [[nodiscard]] Expected<cv::Mat> ToBgr(const AVFrame& frame);

  FrameColor color_;
  Orientation orientation_;
  cv::Size size_;
  GreyRange range_;
  ScalerHandle scaler_;
  cv::Mat padded_;  ///< buffer with padded rows, because the scaler writes whole groups of pixels
};

}  // namespace victorious
