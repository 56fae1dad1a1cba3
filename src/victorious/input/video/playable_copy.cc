#include "victorious/input/video/playable_copy.h"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/progress.h"
#include "victorious/input/video/remuxer.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/input/video/video_writer.h"

namespace victorious {
namespace {

constexpr int kCrf = 20;                   // hardly to be told from the source
constexpr double kKeyFrameInterval_s = 1;  // a seek decodes at most so much

Error CopyCancelled(const std::string& source) { return {ErrorCode::kCancelled, source + ": cancelled"}; }

int NextEven(int pixels) { return pixels + pixels % 2; }

Expected<PlayableCopy> Transcode(const std::string& source, const std::filesystem::path& path,
                                 const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(source, {.color = FrameColor::kBgr}));
  const VideoInfo& info = reader->info();
  if (info.live) return Fail(ErrorCode::kUnsupported, source + ": a live source: it cannot be copied");
  const double rate = info.frame_rate > 0 && info.frame_rate <= 1000 ? info.frame_rate : 25;
  const cv::Size size(NextEven(info.width), NextEven(info.height));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto writer,
      VideoWriter::Create(path, {.width = size.width,
                                 .height = size.height,
                                 .fps = rate,
                                 .crf = kCrf,
                                 .timed = true,
                                 .key_frame_interval = static_cast<int>(std::ceil(kKeyFrameInterval_s * rate))}));
  Progress progress(source, info.frame_count, "frames");
  PlayableCopy copy;
  while (true) {
    if (cancel.IsCancelled()) return std::unexpected(CopyCancelled(source));
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    if (frame->image.size() != size) cv::resize(frame->image, frame->image, size, 0, 0, cv::INTER_LINEAR);
    VICTORIOUS_RETURN_IF_ERROR(writer->WriteAt(frame->image, frame->time_s));
    progress.Update(++copy.frames);
  }
  VICTORIOUS_RETURN_IF_ERROR(writer->Finish());
  return copy;
}

}  // namespace

Expected<PlayableCopy> WritePlayableCopy(const std::string& source, const std::filesystem::path& path,
                                         const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> remuxed, Remux(source, path, cancel));
  if (remuxed) return PlayableCopy{.is_remuxed = true, .frames = *remuxed};
  return Transcode(source, path, cancel);
}

}  // namespace victorious
