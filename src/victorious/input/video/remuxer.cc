#include "victorious/input/video/remuxer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "victorious/base/progress.h"
#include "victorious/input/video/demuxer.h"
#include "victorious/input/video/ffmpeg_handles.h"
#include "victorious/input/video/packet_file.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// The time stamps of the file's packets, in units of its time base.
struct PacketSurvey {
  std::vector<std::int64_t> stamps;  // of presentation, ascending
  std::int64_t step = 1;             // usual one, from frame to frame
  std::int64_t delay = 0;            // from the decoding of a frame to its presentation, at most
};

bool IsCopyable(const AVStream& stream) {
  const AVCodecParameters& codec = *stream.codecpar;
  const auto is_square = [](AVRational aspect) { return aspect.num == 0 || aspect.num == aspect.den; };
  return codec.codec_id == AV_CODEC_ID_H264 &&
         (codec.format == AV_PIX_FMT_YUV420P || codec.format == AV_PIX_FMT_YUVJ420P) && codec.extradata_size > 0 &&
         codec.width % 2 == 0 && codec.height % 2 == 0 &&
         (codec.field_order == AV_FIELD_UNKNOWN || codec.field_order == AV_FIELD_PROGRESSIVE) &&
         is_square(codec.sample_aspect_ratio) && is_square(stream.sample_aspect_ratio) &&
         av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr) == nullptr;
}

// The usual step from frame to frame.
std::int64_t MedianStep(const std::vector<std::int64_t>& stamps) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  if (steps.empty()) return 1;
  const auto middle = steps.begin() + std::ssize(steps) / 2;
  std::ranges::nth_element(steps, middle);
  return *middle;
}

// Of the copy's time base, which is the source's, or that divided until it is at most 1/10000 s.
std::int64_t Ticks(std::int64_t duration, AVRational time_base) {
  return av_rescale_q(duration, time_base, {1, std::max(time_base.den, 20'000)});
}

// Files may hold any time stamps: MP4 has 32 bits for a frame's duration, and sums of them must not overflow.
// @param stamps  ascending
bool AreCopyable(const std::vector<std::int64_t>& stamps, AVRational time_base) {
  constexpr std::int64_t kMaxSpan = std::int64_t{1} << 53;
  constexpr std::int64_t kMaxStep = INT32_MAX / 4;
  const auto is_within = [&](std::int64_t duration, std::int64_t most) {
    if (duration > most) return false;
    const std::int64_t ticks = Ticks(duration, time_base);
    return ticks >= 0 && ticks <= most;  // negative: it overflowed
  };
  std::int64_t span = 0;
  if (__builtin_sub_overflow(stamps.back(), stamps.front(), &span) || !is_within(span, kMaxSpan)) return false;
  return std::ranges::adjacent_find(stamps, [&](std::int64_t a, std::int64_t b) {
           return a == b || !is_within(b - a, kMaxStep);
         }) == stamps.end();
}

bool IsOfVideo(const Demuxer& demuxer, const AVPacket& packet) { return packet.stream_index == demuxer.video().index; }

void KeepVideo(Demuxer& demuxer) {
  demuxer.KeepStreams([index = demuxer.video().index](const AVStream& stream) { return stream.index == index; });
}

// std::nullopt: a packet cannot be copied as it is.
std::optional<PacketSurvey> Survey(Demuxer& demuxer, const CancelToken& cancel) {
  KeepVideo(demuxer);
  const PacketHandle packet(av_packet_alloc());
  std::vector<std::int64_t> stamps;
  int result = 0;
  bool is_sound = true;
  while (is_sound && !cancel.IsCancelled() && (result = demuxer.Read(packet.get())) >= 0) {
    if (IsOfVideo(demuxer, *packet)) {
      constexpr int kUnfit = AV_PKT_FLAG_CORRUPT | AV_PKT_FLAG_DISCARD;
      is_sound = packet->pts != AV_NOPTS_VALUE && (packet->flags & kUnfit) == 0 &&
                 (stamps.empty() ? (packet->flags & AV_PKT_FLAG_KEY) != 0 : packet->pts > stamps.front());
      stamps.push_back(packet->pts);
    }
    av_packet_unref(packet.get());
  }
  if (!is_sound || result != AVERROR_EOF || stamps.empty()) return std::nullopt;
  PacketSurvey survey{.stamps = stamps, .delay = 0};
  std::ranges::sort(survey.stamps);
  if (!AreCopyable(survey.stamps, demuxer.video().time_base)) return std::nullopt;
  survey.step = MedianStep(survey.stamps);
  for (std::size_t i = 0; i < stamps.size(); ++i) survey.delay = std::max(survey.delay, survey.stamps[i] - stamps[i]);
  return survey;
}

// Until the next frame; of the last one the usual step. Without it, the file would end when the last frame begins.
std::int64_t DurationAt(const PacketSurvey& survey, std::int64_t pts) {
  const auto next = std::ranges::upper_bound(survey.stamps, pts);
  return next == survey.stamps.end() ? survey.step : *next - pts;
}

}  // namespace

Expected<std::optional<std::int64_t>> Remux(const std::string& source, const fs::path& path,
                                            const CancelToken& cancel) {
  PrepareFfmpeg();
  std::error_code error;
  if (!fs::is_regular_file(source, error)) return std::nullopt;
  const auto cancelled = [&] { return Fail(ErrorCode::kCancelled, source + ": cancelled"); };
  PacketSurvey survey;
  {
    const auto demuxer = Demuxer::Open({.name = source});
    if (!demuxer || !IsCopyable((*demuxer)->video())) return std::nullopt;
    const auto surveyed = Survey(**demuxer, cancel);
    if (cancel.IsCancelled()) return cancelled();
    if (!surveyed) return std::nullopt;
    survey = *surveyed;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto demuxer, Demuxer::Open({.name = source}));
  KeepVideo(*demuxer);
  PacketFile file(path, fmt::format("{}.tmp-{}", path.string(), ::getpid()));
  VICTORIOUS_RETURN_IF_ERROR(file.Open("mp4", std::array{&std::as_const(demuxer->video())}, PacketFlush::kBuffered));
  Progress progress(source, std::ssize(survey.stamps), "frames");
  const PacketHandle packet(av_packet_alloc());
  const std::int64_t first = survey.stamps.front();
  std::size_t frames = 0;
  while (demuxer->Read(packet.get()) >= 0) {
    if (cancel.IsCancelled()) return cancelled();
    if (IsOfVideo(*demuxer, *packet)) {
      if (frames == survey.stamps.size()) break;
      // Not every container has times of decoding: frames are decoded at the times at which others are presented.
      packet->duration = DurationAt(survey, packet->pts);
      packet->pts -= first;
      packet->dts = survey.stamps[frames] - survey.delay - first;
      VICTORIOUS_RETURN_IF_ERROR(file.Write(*packet, 0, demuxer->video().time_base));
      progress.Update(static_cast<std::int64_t>(++frames));
    }
    av_packet_unref(packet.get());
  }
  if (frames != survey.stamps.size()) return Fail(ErrorCode::kDataLoss, source + ": changed while it was copied");
  VICTORIOUS_RETURN_IF_ERROR(file.Finish());
  return static_cast<std::int64_t>(frames);
}

}  // namespace victorious
