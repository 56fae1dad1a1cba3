// Encodes frames into a video file (MP4 or MKV, H.264): drawn and rendered scenes, never the user's own video.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/base/error.h"
#include "victorious/types/frame.h"

namespace victorious {

struct VideoWriterOptions {
  int width = 640;    ///< px, even
  int height = 480;   ///< px, even
  double fps = 10.0;  ///< frames/s
  int crf = 18;       ///< x264's constant rate factor: 0 lossless to 51
};

/// Not thread-safe. Nothing stands under `path` until Finish() has succeeded.
class VideoWriter {
 public:
  /// @param path  ends in .mp4 or .mkv, which chooses the container; a file of that name is replaced
  /// Errors: kInvalidArgument (another ending, an odd size, …), kNotFound, kPermissionDenied, kNoSpace. After a failed
  /// call the writer can only be destroyed, which removes what was written.
  static Expected<std::unique_ptr<VideoWriter>> Create(const std::filesystem::path& path,
                                                       const VideoWriterOptions& options);
  virtual ~VideoWriter() = default;

  /// Appends a frame (CV_8UC1 or CV_8UC3 BGR, of the size of the options); its time is its number, from 0, over fps.
  virtual Status Write(const cv::Mat& image) = 0;

  /// Flushes the encoder, closes the file and gives it its final name.
  virtual Status Finish() = 0;
};

}  // namespace victorious
