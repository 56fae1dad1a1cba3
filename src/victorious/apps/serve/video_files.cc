#include "victorious/apps/serve/video_files.h"

#include <chrono>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "victorious/apps/decoder/frame_request.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

constexpr std::size_t kImageCacheBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxAtOnce = 8;    // images that are being made while others wait for them
constexpr std::size_t kMaxTables = 256;  // of presentation times, of 0.8 MB an hour
constexpr std::chrono::seconds kFrameTime{30};
constexpr std::chrono::minutes kTableTime{10};  // a whole file may be read for it

// A frame that takes too long is far from a key frame.
Error WithRemedy(Error error) {
  if (error.code == ErrorCode::kUnsupported && error.message.find(" s to read") != std::string::npos) {
    error.message += "; or let a job of the kind copy make a copy of the video that browsers play";
  }
  return error;
}

}  // namespace

VideoFiles::VideoFiles(const VideoRoots& roots)
    : roots_(roots), images_(kImageCacheBytes), making_(kMaxAtOnce), times_(kMaxTables) {}

// A content id is a hash or a text with any characters.
std::string CopyName(const VideoRecord& video) {
  return fmt::format("{:016x}.mp4", Checksum(std::as_bytes(std::span(video.content_id))));
}

Expected<std::shared_ptr<const std::string>> VideoFiles::Jpeg(const VideoRecord& video, const FrameRequest& request,
                                                              const std::string& key, const CancelToken& cancel) {
  if (auto cached = images_.Find(key)) return cached;
  auto made = GetUnlessCancelled(making_, key, cancel, [&]() -> Expected<std::string> {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, Find(video));
    FrameRequest of_file = request;
    of_file.video = path.string();
    return decoders_.Ask(path, kFrameRequest + PackFrameRequest(of_file), {.patience = kFrameTime, .cancel = &cancel});
  });
  if (!made) return std::unexpected(WithRemedy(std::move(made).error()));
  images_.Put(key, *made);
  return made;
}

Expected<std::shared_ptr<const std::string>> VideoFiles::Frame(const VideoRecord& video, double time_s,
                                                               const CancelToken& cancel) {
  return Jpeg(video, {.task = FrameTask::kJpeg, .time_s = time_s}, fmt::format("{} {:.6f}", video.content_id, time_s),
              cancel);
}

Expected<std::shared_ptr<const std::string>> VideoFiles::Crop(const VideoRecord& video, double time_s, const Box& box,
                                                              int width_px, const CancelToken& cancel) {
  const std::string key = fmt::format("{} {:.6f} {:.1f} {:.1f} {:.1f} {:.1f} {}", video.content_id, time_s, box.x,
                                      box.y, box.width, box.height, width_px);
  return Jpeg(video, {.task = FrameTask::kJpeg, .time_s = time_s, .box = box, .width_px = width_px}, key, cancel);
}

Expected<cv::Mat> VideoFiles::GreyFrame(const VideoRecord& video, double time_s, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, Find(video));
  const auto bytes = decoders_.Ask(
      path, kFrameRequest + PackFrameRequest({.task = FrameTask::kGrey, .video = path.string(), .time_s = time_s}),
      {.patience = kFrameTime, .cancel = &cancel});
  if (!bytes) return std::unexpected(WithRemedy(bytes.error()));
  return UnpackGrey(*bytes);
}

Expected<std::shared_ptr<const std::vector<double>>> VideoFiles::Times(const VideoRecord& video,
                                                                       const CancelToken& cancel) {
  return GetUnlessCancelled(times_, video.content_id, cancel, [&]() -> Expected<std::vector<double>> {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, Find(video));
    const FrameRequest request{.task = FrameTask::kTimes, .video = path.string(), .frames = video.frame_count};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, decoders_.Ask(path, kFrameRequest + PackFrameRequest(request),
                                                                       {.patience = kTableTime, .cancel = &cancel}));
    return UnpackTimes(bytes);
  });
}

Expected<CameraStates> VideoFiles::Cameras(const VideoRecord& video, const std::filesystem::path& path,
                                           const TelemetryOptions& options, const WarningSink& warn,
                                           const CancelToken& cancel) {
  const CameraRequest request{.video = path.string(),
                              .duration_s = video.duration_s,
                              .width = video.width,
                              .height = video.height,
                              .file = roots_.Telemetry(video, warn),
                              .options = options,
                              .consequence = "the map has no camera path"};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string answer, decoders_.AskOnce(request.video, FilesOfCameraRequest(request),
                                                                          kCameraRequest + PackCameraRequest(request),
                                                                          {.patience = kTableTime, .cancel = &cancel}));
  return UnpackCameraAnswer(answer, warn);
}

}  // namespace victorious
