// Encodes frames as a video file (MP4 or MKV, H.264), for rendered scenes and drawn results; never writes to the user's
// own videos. Frames have a constant rate, or each its own time.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/base/error.h"
#include "victorious/types/frame.h"

namespace victorious {

struct VideoWriterOptions {
  int width = 640;    ///< px, even, 2 to 16384
  int height = 480;   ///< px, even, 2 to 16384
  double fps = 10.0;  ///< frames/s, above 0, at most 1000
  int crf = 18;       ///< x264's constant rate factor, 0 (lossless) to 51
  /// Each frame is written with its own time (WriteAt); `fps` is then only the nominal rate.
  bool timed = false;
  int key_frame_interval = 250;  ///< frames between key frames at most, from 1: a seek decodes so many
};

/// Not thread-safe. Writes to a temporary file; `path` is created or replaced only when Finish() succeeds.
class VideoWriter {
 public:
  /// @param path  file extension .mp4 or .mkv determines the container; an existing file is replaced
  /// Errors: kInvalidArgument (another extension, an odd size, …), kNotFound, kPermissionDenied, kNoSpace, kUnsupported
  /// (FFmpeg without libx264). After a failed call the writer can only be destroyed, which removes the temporary file.
  [[nodiscard]] static Expected<std::unique_ptr<VideoWriter>> Create(const std::filesystem::path& path,
                                                                     const VideoWriterOptions& options);
  virtual ~VideoWriter() = default;

  /// Appends a frame (CV_8UC1 or CV_8UC3 BGR, of the size in the options). Frame n, from 0, has the time n / fps.
  /// Errors: kInvalidArgument (size or type), kNoSpace, kInternal.
  [[nodiscard]] virtual Status Write(const cv::Mat& image) = 0;

  /// Appends a frame with its presentation time; only with VideoWriterOptions::timed, and Write only without.
  /// @param time_s  from 0, at least 1/90000 s later than the frame before. MKV stores times with a resolution of 1 ms
  /// Errors: those of Write; kInvalidArgument for a time that is not later.
  [[nodiscard]] virtual Status WriteAt(const cv::Mat& image, double time_s) = 0;

  /// Flushes the encoder, closes the file and renames it to `path`. Errors: kInvalidArgument (no frames), kNoSpace, ….
  [[nodiscard]] virtual Status Finish() = 0;
};

}  // namespace victorious
