#include "victorious/jobs/index/segment_reader.h"

#include <cmath>
#include <utility>

namespace victorious {
SegmentReader::SegmentReader(std::unique_ptr<VideoReader> reader, std::span<const double> times_s, FrameInterval frames)
    : reader_(std::move(reader)), times_s_(times_s), frames_(frames), info_(reader_->info()), next_(frames.from) {
  info_.frame_count = frames.to;
}

Expected<std::unique_ptr<SegmentReader>> SegmentReader::Open(const std::string& source,
                                                             const VideoReaderOptions& options,
                                                             std::span<const double> times_s, FrameInterval frames) {
  const auto open = [&]() -> Expected<std::unique_ptr<SegmentReader>> {
    VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<VideoReader> reader, VideoReader::Open(source, options));
    if (reader->info().live) {
      return Fail(ErrorCode::kInvalidArgument, source + ": a live source has no segments: index it as a whole");
    }
    return std::unique_ptr<SegmentReader>(new SegmentReader(std::move(reader), times_s, frames));
  };
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<SegmentReader> entered, open());
  if (frames.from > 0 && entered->reader_->SeekTo(entered->TimeOf(frames.from))) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_found, entered->FindFirst());
    if (is_found && entered->IsExact()) return entered;
    VICTORIOUS_ASSIGN_OR_RETURN(entered, open());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(entered->is_exact_, entered->FindFirst());
  return entered;
}

Expected<bool> SegmentReader::FindFirst() {
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader_->NextFrame());
    if (!frame) return false;
    if (frame->time_s < TimeOf(frames_.from) - kSameTime_s) continue;
    if (frame->time_s > TimeOf(frames_.from) + kSameTime_s) return false;
    first_ = std::move(frame);
    return true;
  }
}

Expected<std::optional<Frame>> SegmentReader::NextFrame() {
  if (!is_exact_ || next_ >= frames_.to) return std::nullopt;
  std::optional<Frame> frame = std::exchange(first_, std::nullopt);
  if (!frame) {
    VICTORIOUS_ASSIGN_OR_RETURN(frame, reader_->NextFrame());
  }
  if (!frame || std::abs(frame->time_s - TimeOf(next_)) > kSameTime_s) {
    is_exact_ = false;
    return std::nullopt;
  }
  frame->index = next_++;
  // The last segment ends with the video.
  if (next_ == std::ssize(times_s_)) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> more, reader_->NextFrame());
    is_exact_ = is_exact_ && !more;
  }
  return frame;
}

}  // namespace victorious
