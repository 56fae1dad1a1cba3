// Private to video/: a decoded picture of any of FFmpeg's pixel formats as an upright 8-bit cv::Mat of square pixels.
//
// Grey comes straight from the luma plane where that is BT.601 luma; limited range (16..235) is stretched to 0..255 and
// deeper samples are brought down to 8 bits in the same pass. Everything else goes through BGR.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/video/ffmpeg_handles.h"
#include "victorious/video/orientation.h"
#include "victorious/video/video_reader.h"

namespace victorious {

class FrameConverter {
 public:
  /// @param size  before turning, with square pixels; frames of another size are scaled to it
  FrameConverter(FrameColor color, Orientation orientation, cv::Size size)
      : color_(color), orientation_(orientation), size_(size) {}

  /// A picture that owns its pixels.
  Expected<cv::Mat> Convert(const AVFrame& frame);

 private:
  Expected<cv::Mat> ConvertAndTurn(const AVFrame& frame);
  Expected<cv::Mat> ConvertColor(const AVFrame& frame);
  Expected<cv::Mat> ToBgr(const AVFrame& frame);

  FrameColor color_;
  Orientation orientation_;
  cv::Size size_;
  ScalerHandle scaler_;
  cv::Mat padded_;  ///< rows that the scaler may overrun
};

}  // namespace victorious
