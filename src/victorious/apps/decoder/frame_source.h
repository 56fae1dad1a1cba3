// Answers requests about one video (frame_request.h), in an isolated process. The video stays open between requests: a
// process that has shown one of its frames shows the next without reading the container again.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "victorious/apps/decoder/frame_request.h"
#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {

class FrameSource {
 public:
  /// @param packed  by PackFrameRequest
  /// Errors: those of reading; kNotFound beyond the video's end. May throw std::bad_alloc.
  [[nodiscard]] Expected<std::string> Answer(std::string_view packed);

 private:
  /// The first frame at or after a time.
  [[nodiscard]] Expected<cv::Mat> Read(const std::string& video, double time_s, FrameColor color);
  /// Places the reader before a time.
  [[nodiscard]] Status Open(const std::string& video, double time_s, FrameColor color);

  std::unique_ptr<VideoReader> reader_;
  FrameColor color_ = FrameColor::kBgr;  ///< of `reader_`
};

}  // namespace victorious
