// The videos of an index as files: their frames as JPEG, crops of objects, and their tables of
// presentation times. Processes without rights read the files (decoder_pool.h). Results are cached in memory; what
// several ask for at once is made once. Thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/apps/decoder/frame_request.h"
#include "victorious/apps/serve/byte_cache.h"
#include "victorious/apps/serve/decoder_pool.h"
#include "victorious/apps/serve/once_cache.h"
#include "victorious/apps/serve/video_roots.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/place/cameras/camera_request.h"
#include "victorious/types/index_records.h"

namespace victorious {

class VideoFiles {
 public:
  /// @param roots  where the videos are; must outlive this
  explicit VideoFiles(const VideoRoots& roots);

  [[nodiscard]] const VideoRoots& roots() const { return roots_; }

  /// The path of a video. Errors: those of VideoRoots::Find.
  [[nodiscard]] Expected<std::filesystem::path> Find(const VideoRecord& video) const { return roots_.Find(video); }

  /// The frame at a time, as JPEG. Errors: those of Find and of reading; kNotFound beyond the end; kUnsupported for an
  /// image of more than kMaxServedPixels, or one that takes more than 30 s; kCancelled.
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> Frame(const VideoRecord& video, double time_s,
                                                                   const CancelToken& cancel);

  /// The region of the frame around a box, with a margin, as JPEG of 4:3. Errors: those of Frame.
  /// @param width_px  of the result
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> Crop(const VideoRecord& video, double time_s,
                                                                  const Box& box, int width_px,
                                                                  const CancelToken& cancel);

  /// The frame at a time, CV_8UC1, as a search reads it. Errors: those of Frame.
  [[nodiscard]] Expected<cv::Mat> GreyFrame(const VideoRecord& video, double time_s, const CancelToken& cancel);

  /// The presentation times of all frames (input/video/frame_times.h). Errors: those of Find and of reading;
  /// kUnsupported if it takes more than 10 minutes; kCancelled.
  [[nodiscard]] Expected<std::shared_ptr<const std::vector<double>>> Times(const VideoRecord& video,
                                                                           const CancelToken& cancel);

  /// What the telemetry of a video says of its camera: CameraStates::Load. Errors: those of it; kUnsupported if it
  /// takes more than 10 minutes; kCancelled.
  /// @param path  of the video
  [[nodiscard]] Expected<CameraStates> Cameras(const VideoRecord& video, const std::filesystem::path& path,
                                               const TelemetryOptions& options, const WarningSink& warn,
                                               const CancelToken& cancel);

 private:
  /// @param request  without the video's path
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> Jpeg(const VideoRecord& video, const FrameRequest& request,
                                                                  const std::string& key, const CancelToken& cancel);

  const VideoRoots& roots_;
  DecoderPool decoders_;
  ByteCache images_;
  OnceCache<std::string> making_;         ///< images by the same keys
  OnceCache<std::vector<double>> times_;  ///< by content id
};

/// The file name of the copy of a video that browsers play (input/video/playable_copy.h). It belongs to the video's
/// content, not to its name.
[[nodiscard]] std::string CopyName(const VideoRecord& video);

}  // namespace victorious
