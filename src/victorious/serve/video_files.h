// The videos of an index as files: where they are, their frames as JPEG, crops of objects, and their tables of
// presentation times. Results are cached in memory. Thread-safe; at most two frames are decoded at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <semaphore>
#include <string>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/serve/byte_cache.h"
#include "victorious/store/index_store.h"
#include "victorious/video/video_reader.h"

namespace victorious {

class VideoFiles {
 public:
  /// @param index   the file of the index: a relative name of a video that is not found from the current folder is
  ///                looked for from the index's folder; empty: there is no file
  /// @param cancel  ends long reading; must outlive this
  VideoFiles(const std::filesystem::path& index, const CancelToken& cancel);

  /// The path of a video. Errors: kNotFound with the name and the remedy; kUnsupported for a live source.
  [[nodiscard]] Expected<std::filesystem::path> Find(const VideoRecord& video) const;

  /// The frame at a time, as JPEG. Errors: those of Find and of reading; kNotFound beyond the end.
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> Frame(const VideoRecord& video, double time_s);

  /// The region of the frame around a box, with a margin, as JPEG of 4:3. Errors: those of Frame.
  /// @param width_px  of the result
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> Crop(const VideoRecord& video, double time_s,
                                                                  const Box& box, int width_px);

  /// The frame at a time, CV_8UC1, as a search reads it. Errors: those of Frame.
  [[nodiscard]] Expected<cv::Mat> GreyFrame(const VideoRecord& video, double time_s);

  /// The presentation times of all frames (video/frame_times.h). Errors: those of Find and of reading.
  [[nodiscard]] Expected<std::shared_ptr<const std::vector<double>>> Times(const VideoRecord& video);

 private:
  [[nodiscard]] Expected<cv::Mat> Read(const VideoRecord& video, double time_s, FrameColor color);
  [[nodiscard]] Expected<std::string> Encode(const VideoRecord& video, double time_s, const Box* box, int width_px);

  std::filesystem::path folder_;
  const CancelToken& cancel_;
  ByteCache images_;
  std::counting_semaphore<> decoders_;
  std::mutex times_mutex_;
  std::unordered_map<std::string, std::shared_ptr<const std::vector<double>>> times_;  ///< by content id
};

/// The file name of the copy of a video that browsers play (video/playable_copy.h). It belongs to the video's content,
/// not to its name.
[[nodiscard]] std::string CopyName(const VideoRecord& video);

/// The region of a frame that a crop shows: the box with a margin, at least 48 px, of the aspect 4:3, moved into the
/// frame; a box larger than the frame gives a region that extends beyond it.
[[nodiscard]] Box CropRegion(const Box& box, int frame_width_px, int frame_height_px);

}  // namespace victorious
