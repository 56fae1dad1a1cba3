// What the server asks the program victorious-decoder about one video, and the answers as bytes. Both ends are of one
// build. The answers may come from a process that a hostile video has taken over: what reads them here checks them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// The name of the function of the program (base/isolated_main.h) that answers the page. A request is one of these
/// characters, and what it asks for.
inline constexpr std::string_view kPage = "page";
inline constexpr char kFrameRequest = 'f';   ///< PackFrameRequest
inline constexpr char kCameraRequest = 'c';  ///< place/cameras/camera_request.h

/// Pixels of the largest image that is decoded for the page: 8192 x 8192.
inline constexpr std::uint64_t kMaxServedPixels = std::uint64_t{1} << 26;

enum class FrameTask {
  kTimes,  ///< the presentation times of all frames (input/video/frame_times.h)
  kJpeg,   ///< a frame, or a crop of it, as JPEG
  kGrey,   ///< a frame as a search reads it
};

struct FrameRequest {
  FrameTask task = FrameTask::kJpeg;
  std::string video;                        ///< its path; the same in all requests to one process
  double time_s = 0;                        ///< of the frame
  std::optional<Box> box = {};              ///< of the object that the crop shows; std::nullopt: the whole frame
  int width_px = 0;                         ///< of the crop
  std::optional<std::int64_t> frames = {};  ///< of the video, for kTimes
};

[[nodiscard]] std::string PackFrameRequest(const FrameRequest& request);
/// Only for what PackFrameRequest made.
[[nodiscard]] FrameRequest UnpackFrameRequest(std::string_view bytes);

[[nodiscard]] std::string PackTimes(const std::vector<double>& times_s);
/// Error: kDataLoss unless the times increase from 0 or later.
[[nodiscard]] Expected<std::vector<double>> UnpackTimes(std::string_view bytes);

/// @param grey  CV_8UC1
[[nodiscard]] std::string PackGrey(const cv::Mat& grey);
/// Error: kDataLoss unless it is an image of at most kMaxServedPixels.
[[nodiscard]] Expected<cv::Mat> UnpackGrey(std::string_view bytes);

}  // namespace victorious
