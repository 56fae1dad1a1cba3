// Reads the frames of a video backward, for the backward pass of user-specified tracking (track_job.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/types/frame.h"

namespace victorious {

/// Opens a video in colour. Errors: those of VideoReader; kInvalidArgument for a live source, which cannot be read
/// twice.
[[nodiscard]] Expected<std::unique_ptr<VideoReader>> OpenRereadable(const std::string& video);

class ReverseFrameReader {
 public:
  /// @param video      file or folder
  /// @param times_s    time stamps of its frames, as read forward; outlive the reader
  /// @param memory_mb  memory for frames, MiB: less reads the video more often
  ReverseFrameReader(std::string video, std::span<const double> times_s, int memory_mb, const CancelToken& cancel)
      : video_(std::move(video)), times_s_(times_s), memory_mb_(memory_mb), cancel_(cancel) {}

  /// Calls `visit` with the frames end - 1, end - 2, ..., 0. Frames that cannot be read again are left out. Reads
  /// intervals of frames that fit into the memory, each from the key frame before it if the video is seekable there,
  /// else from the beginning.
  /// Errors: those of the video and of `visit`; kCancelled.
  [[nodiscard]] Status ForEach(std::int64_t end, const std::function<Status(const Frame&)>& visit) const;

  /// Reads the frames [first, end) that are wanted, as the forward pass saw them, likewise.
  /// @param is_wanted  of a frame's index; empty: all
  /// Errors: those of the video; kCancelled.
  [[nodiscard]] Expected<std::vector<Frame>> ReadInterval(
      std::int64_t first, std::int64_t end, const std::function<bool(std::int64_t)>& is_wanted = {}) const;

 private:
  [[nodiscard]] Expected<std::vector<Frame>> ReadOn(VideoReader& reader, std::int64_t first, std::int64_t end,
                                                    const std::function<bool(std::int64_t)>& is_wanted) const;

  std::string video_;
  std::span<const double> times_s_;
  int memory_mb_;
  const CancelToken& cancel_;
};

}  // namespace victorious
