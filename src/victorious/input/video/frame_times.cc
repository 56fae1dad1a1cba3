#include "victorious/input/video/frame_times.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include "victorious/input/video/demuxer.h"
#include "victorious/input/video/ffmpeg_handles.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

Error Cancelled(const std::string& source) { return {ErrorCode::kCancelled, source + ": cancelled"}; }

// Presentation time stamps, in the time base of the stream.
struct Stamps {
  std::vector<std::int64_t> all;
  std::vector<std::int64_t> key;  // of key frames
};

// The stamps of all packets whose frames are presented, in presentation order; empty if one is missing or repeated, or
// a packet cannot be read.
Stamps ReadStamps(Demuxer& demuxer, const CancelToken& cancel) {
  const int video = demuxer.video().index;
  demuxer.KeepStreams([&](const AVStream& stream) { return stream.index == video; });
  const PacketHandle packet(av_packet_alloc());
  Stamps stamps;
  int result = 0;
  while ((result = demuxer.Read(packet.get())) >= 0 && !cancel.IsCancelled()) {
    const bool is_shown = packet->stream_index == video && (packet->flags & AV_PKT_FLAG_DISCARD) == 0;
    const bool is_sound = packet->pts != AV_NOPTS_VALUE && (packet->flags & AV_PKT_FLAG_CORRUPT) == 0;
    if (is_shown && is_sound) {
      stamps.all.push_back(packet->pts);
      if ((packet->flags & AV_PKT_FLAG_KEY) != 0) stamps.key.push_back(packet->pts);
    }
    av_packet_unref(packet.get());
    if (is_shown && !is_sound) return {};
  }
  if (result != AVERROR_EOF) return {};
  std::ranges::sort(stamps.all);
  std::ranges::sort(stamps.key);
  if (std::ranges::adjacent_find(stamps.all) != stamps.all.end()) return {};
  return stamps;
}

// Seconds since the first stamp.
std::vector<double> TimesOf(const std::vector<std::int64_t>& stamps, std::int64_t first, double tick_s) {
  std::vector<double> times_s;
  times_s.reserve(stamps.size());
  for (const std::int64_t stamp : stamps) times_s.push_back(static_cast<double>(stamp - first) * tick_s);
  return times_s;
}

Expected<std::vector<double>> DecodeTimes(const std::string& source, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(source, {}));
  std::vector<double> times_s;
  while (true) {
    if (cancel.IsCancelled()) return std::unexpected(Cancelled(source));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) return times_s;
    times_s.push_back(frame->time_s);
  }
}

}  // namespace

Expected<std::vector<double>> ReadFrameTimes(const std::string& source, std::optional<std::int64_t> frame_count,
                                             const CancelToken& cancel) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(source, error)) return DecodeTimes(source, cancel);
  const auto demuxer = Demuxer::Open({.name = source});
  if (!demuxer) return DecodeTimes(source, cancel);  // an image, or an error that VideoReader describes
  const Stamps stamps = ReadStamps(**demuxer, cancel);
  if (cancel.IsCancelled()) return std::unexpected(Cancelled(source));
  const bool is_complete = !stamps.all.empty() && (!frame_count || std::ssize(stamps.all) == *frame_count);
  if (!is_complete) return DecodeTimes(source, cancel);
  return TimesOf(stamps.all, stamps.all.front(), av_q2d((*demuxer)->video().time_base));
}

Expected<std::optional<FrameTable>> ReadFrameTable(const std::string& source, const CancelToken& cancel) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(source, error)) return std::nullopt;
  const auto demuxer = Demuxer::Open({.name = source});
  if (!demuxer) return std::nullopt;
  const Stamps stamps = ReadStamps(**demuxer, cancel);
  if (cancel.IsCancelled()) return std::unexpected(Cancelled(source));
  if (stamps.all.empty()) return std::nullopt;
  const double tick_s = av_q2d((*demuxer)->video().time_base);
  return FrameTable{TimesOf(stamps.all, stamps.all.front(), tick_s), TimesOf(stamps.key, stamps.all.front(), tick_s)};
}

}  // namespace victorious
