#include "victorious/apps/decoder/frame_source.h"

#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "victorious/apps/decoder/crop.h"
#include "victorious/base/cancel.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/video/frame_times.h"

namespace victorious {
namespace {

constexpr double kTimeTolerance_s = 1e-4;
constexpr int kFrameQuality = 90;
constexpr int kCropQuality = 82;

Expected<std::string> EncodedJpeg(const cv::Mat& image, int quality) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, EncodeJpeg(image, quality));
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

}  // namespace

Expected<std::string> FrameSource::Answer(std::string_view packed) {
  const FrameRequest request = UnpackFrameRequest(packed);
  try {
    if (request.task == FrameTask::kTimes) {
      const CancelToken never;  // who asks kills this process
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> times_s,
                                  ReadFrameTimes(request.video, request.frames, never));
      return PackTimes(times_s);
    }
    const bool is_grey = request.task == FrameTask::kGrey;
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat frame,
                                Read(request.video, request.time_s, is_grey ? FrameColor::kGrey : FrameColor::kBgr));
    if (is_grey) return PackGrey(frame);
    if (!request.box) return EncodedJpeg(frame, kFrameQuality);
    return EncodedJpeg(CutOut(frame, CropRegion(*request.box, frame.cols, frame.rows), request.width_px), kCropQuality);
  } catch (const cv::Exception& exception) {
    if (exception.code != cv::Error::StsNoMem) throw;
    throw std::bad_alloc();
  }
}

Expected<cv::Mat> FrameSource::Read(const std::string& video, double time_s, FrameColor color) {
  VICTORIOUS_RETURN_IF_ERROR(Open(video, time_s, color));
  while (true) {
    Expected<std::optional<Frame>> frame = reader_->NextFrame();
    if (frame && *frame && (*frame)->time_s >= time_s - kTimeTolerance_s) return (*frame)->image;
    if (frame && *frame) continue;
    reader_.reset();
    if (!frame) return std::unexpected(std::move(frame).error());
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no frame at {:.3f} s", video, time_s));
  }
}

Status FrameSource::Open(const std::string& video, double time_s, FrameColor color) {
  if (reader_ && color_ == color && reader_->SeekTo(time_s)) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(reader_, VideoReader::Open(video, {.color = color, .threads = 1}));
  color_ = color;
  reader_->SeekTo(time_s);  // if it cannot, the frames are read from the beginning
  return {};
}

}  // namespace victorious
