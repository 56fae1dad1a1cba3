#include "victorious/serve/video_files.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/file.h"
#include "victorious/image/image_file.h"
#include "victorious/video/frame_times.h"

namespace victorious {
namespace {

constexpr std::size_t kImageCacheBytes = std::size_t{64} << 20;
constexpr std::ptrdiff_t kMaxDecoders = 2;
constexpr double kTimeTolerance_s = 1e-4;

std::string ToString(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The first frame at or after a time.
Expected<cv::Mat> ReadFrameAt(const std::string& path, double time_s, FrameColor color, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto reader, VideoReader::Open(path, {.color = color, .threads = 1}));
  reader->SeekTo(time_s);  // if it cannot, the frames are read from the beginning
  while (!cancel.IsCancelled()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) return Fail(ErrorCode::kNotFound, fmt::format("{}: no frame at {:.3f} s", path, time_s));
    if (frame->time_s >= time_s - kTimeTolerance_s) return frame->image;
  }
  return Fail(ErrorCode::kCancelled, path + ": cancelled");
}

cv::Mat CutOut(const cv::Mat& frame, const Box& region, int width_px) {
  // A border where the region extends beyond the frame.
  cv::Mat cut;
  const double scale = width_px / region.width;
  const cv::Size size(width_px, static_cast<int>(std::lround(region.height * scale)));
  const cv::Matx23d cut_from_frame(scale, 0, -region.x * scale, 0, scale, -region.y * scale);
  const int interpolation = scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC;
  if (const cv::Rect inside(cv::Point2d(std::floor(region.x), std::floor(region.y)),
                            cv::Point2d(std::ceil(region.x + region.width), std::ceil(region.y + region.height)));
      scale < 1 && (inside & cv::Rect({0, 0}, frame.size())) == inside) {
    cv::resize(frame(inside), cut, size, 0, 0, interpolation);
  } else {
    cv::warpAffine(frame, cut, cut_from_frame, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(24));
  }
  return cut;
}

}  // namespace

Box CropRegion(const Box& box, int frame_width_px, int frame_height_px) {
  constexpr double kMargin = 1.5;  // side of the region over the side of the box
  constexpr double kMinHeight_px = 48;
  constexpr double kAspect = 4.0 / 3;
  const double height = std::max({kMinHeight_px, kMargin * box.height, kMargin * box.width / kAspect});
  Box region{0, 0, kAspect * height, height};
  const auto place = [](double centre, double side, double limit) {
    if (side >= limit) return (limit - side) / 2;
    return std::clamp(centre - side / 2, 0.0, limit - side);
  };
  region.x = place(box.x + box.width / 2, region.width, frame_width_px);
  region.y = place(box.y + box.height / 2, region.height, frame_height_px);
  return region;
}

VideoFiles::VideoFiles(const std::filesystem::path& index, const CancelToken& cancel)
    : folder_(index.parent_path()), cancel_(cancel), images_(kImageCacheBytes), decoders_(kMaxDecoders) {}

Expected<std::filesystem::path> VideoFiles::Find(const VideoRecord& video) const {
  if (video.name.find("://") != std::string::npos) {
    return Fail(ErrorCode::kUnsupported, ShownName(video) + ": a live source: its frames are not kept");
  }
  std::error_code error;
  const std::filesystem::path path = FindVideoFile(video);
  if (std::filesystem::exists(path, error)) return path;
  if (path.is_relative() && std::filesystem::exists(folder_ / path, error)) return folder_ / path;
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: the video is not there: move it back, or start `victorious serve` in the folder that "
                          "the index was made in",
                          ShownName(video)));
}

// A content id is a hash or a text with any characters.
std::string CopyName(const VideoRecord& video) {
  return fmt::format("{:016x}.mp4", Checksum(std::as_bytes(std::span(video.content_id))));
}

Expected<cv::Mat> VideoFiles::Read(const VideoRecord& video, double time_s, FrameColor color) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, Find(video));
  decoders_.acquire();
  Expected<cv::Mat> frame = ReadFrameAt(path.string(), time_s, color, cancel_);
  decoders_.release();
  return frame;
}

Expected<std::string> VideoFiles::Encode(const VideoRecord& video, double time_s, const Box* box, int width_px) {
  VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat frame, Read(video, time_s, FrameColor::kBgr));
  const cv::Mat image = box == nullptr ? frame : CutOut(frame, CropRegion(*box, frame.cols, frame.rows), width_px);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, EncodeJpeg(image, box == nullptr ? 90 : 82));
  return ToString(bytes);
}

Expected<std::shared_ptr<const std::string>> VideoFiles::Frame(const VideoRecord& video, double time_s) {
  const std::string key = fmt::format("{} {:.6f}", video.content_id, time_s);
  if (auto cached = images_.Find(key)) return cached;
  VICTORIOUS_ASSIGN_OR_RETURN(std::string bytes, Encode(video, time_s, nullptr, 0));
  const auto image = std::make_shared<const std::string>(std::move(bytes));
  images_.Put(key, image);
  return image;
}

Expected<std::shared_ptr<const std::string>> VideoFiles::Crop(const VideoRecord& video, double time_s, const Box& box,
                                                              int width_px) {
  const std::string key = fmt::format("{} {:.6f} {:.1f} {:.1f} {:.1f} {:.1f} {}", video.content_id, time_s, box.x,
                                      box.y, box.width, box.height, width_px);
  if (auto cached = images_.Find(key)) return cached;
  VICTORIOUS_ASSIGN_OR_RETURN(std::string bytes, Encode(video, time_s, &box, width_px));
  const auto image = std::make_shared<const std::string>(std::move(bytes));
  images_.Put(key, image);
  return image;
}

Expected<cv::Mat> VideoFiles::GreyFrame(const VideoRecord& video, double time_s) {
  return Read(video, time_s, FrameColor::kGrey);
}

Expected<std::shared_ptr<const std::vector<double>>> VideoFiles::Times(const VideoRecord& video) {
  const std::scoped_lock lock(times_mutex_);
  if (const auto found = times_.find(video.content_id); found != times_.end()) return found->second;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, Find(video));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<double> times_s, ReadFrameTimes(path.string(), video.frame_count, cancel_));
  auto table = std::make_shared<const std::vector<double>>(std::move(times_s));
  times_[video.content_id] = table;
  return table;
}

}  // namespace victorious
