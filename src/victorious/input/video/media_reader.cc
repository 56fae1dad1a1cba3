#include "victorious/input/video/media_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "victorious/input/video/damage_log.h"
#include "victorious/input/video/data_track.h"
#include "victorious/input/video/frame_clock.h"
#include "victorious/input/video/frame_converter.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/time_base_joints.h"

extern "C" {
#include <libavutil/display.h>
}

namespace victorious {
namespace {

constexpr int kMaxThreads = 16;
constexpr auto kRetryPause = std::chrono::milliseconds(10);
constexpr int kMaxReadErrors = 100;     // consecutive errors before reading stops
constexpr int kMaxDecodeErrors = 1000;  // consecutive errors without a packet in between

double FrameRate(const AVStream& stream) {
  constexpr double kMaxRate = 1000;  // greater values are a time base, not a rate
  for (const AVRational rate : {stream.avg_frame_rate, stream.r_frame_rate}) {
    if (rate.num > 0 && rate.den > 0 && av_q2d(rate) <= kMaxRate) return av_q2d(rate);
  }
  return 0;
}

FrameClock MakeFrameClock(const AVStream& stream) {
  constexpr double kDefaultRate = 25;
  const double rate = FrameRate(stream);
  const AVRational tick = stream.time_base;
  return {tick.num > 0 && tick.den > 0 ? av_q2d(tick) : 1 / kDefaultRate, 1 / (rate > 0 ? rate : kDefaultRate)};
}

// Elementary streams have no time stamps; FFmpeg generates some in decoding order.
bool HasTimeStamps(const AVFormatContext& container) {
  static constexpr std::array<std::string_view, 7> kElementaryStreams = {"mpegvideo", "h264", "hevc", "m4v",
                                                                         "vc1",       "obu",  "mjpeg"};
  return std::ranges::find(kElementaryStreams, std::string_view(container.iformat->name)) == kElementaryStreams.end();
}

StreamType TypeOf(const AVStream& stream) {
  switch (stream.codecpar->codec_type) {
    case AVMEDIA_TYPE_VIDEO:
      return StreamType::kVideo;
    case AVMEDIA_TYPE_AUDIO:
      return StreamType::kAudio;
    case AVMEDIA_TYPE_DATA:
      return StreamType::kData;
    case AVMEDIA_TYPE_SUBTITLE:
      return StreamType::kSubtitle;
    default:
      return StreamType::kOther;
  }
}

// FFmpeg's name; of a data track that it does not know, the four letters of its sample entry.
std::string CodecName(const AVStream& stream) {
  const AVCodecParameters& codec = *stream.codecpar;
  const bool is_unknown = codec.codec_id == AV_CODEC_ID_NONE || codec.codec_id == AV_CODEC_ID_BIN_DATA;
  if (!is_unknown || codec.codec_type != AVMEDIA_TYPE_DATA) return avcodec_get_name(codec.codec_id);
  std::string letters;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<unsigned char>(codec.codec_tag >> shift & 0xFF);
    if (std::isalnum(letter) == 0) return avcodec_get_name(codec.codec_id);
    letters += static_cast<char>(letter);
  }
  return letters;
}

Expected<CodecHandle> OpenDecoder(const AVStream& stream, const MediaSource& source, int threads) {
  const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
  const char* codec_name = avcodec_get_name(stream.codecpar->codec_id);
  if (codec == nullptr) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: no decoder for its video ({})", source.name, codec_name));
  }
  CodecHandle decoder(avcodec_alloc_context3(codec));
  if (!decoder || avcodec_parameters_to_context(decoder.get(), stream.codecpar) < 0) {
    return Fail(ErrorCode::kInternal, fmt::format("{}: cannot set up the decoder of {}", source.name, codec_name));
  }
  decoder->pkt_timebase = stream.time_base;
  decoder->max_pixels = kMaxFramePixels;
  decoder->thread_count =
      std::min(threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()), kMaxThreads);
  // Frame threads delay the output by several frames: irrelevant for a file, but latency for a live source.
  decoder->thread_type = source.remote ? FF_THREAD_SLICE : FF_THREAD_FRAME | FF_THREAD_SLICE;
  if (const int result = avcodec_open2(decoder.get(), codec, nullptr); result < 0) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: its video ({}) cannot be decoded: {}", source.name, codec_name,
                                                  FfmpegErrorText(result)));
  }
  return decoder;
}

class MediaReader : public VideoReader {
 public:
  MediaReader(MediaSource source, const VideoReaderOptions& options, std::unique_ptr<Demuxer> demuxer,
              CodecHandle decoder)
      : source_(std::move(source)),
        options_(options),
        demuxer_(std::move(demuxer)),
        decoder_(std::move(decoder)),
        packet_(av_packet_alloc()),
        packet_after_(av_packet_alloc()),
        frame_(av_frame_alloc()),
        lookahead_(av_frame_alloc()),
        clock_(MakeFrameClock(demuxer_->video())),
        joints_(demuxer_->video().time_base),
        has_time_stamps_(HasTimeStamps(demuxer_->container())) {
    demuxer_->KeepStreams([&](const AVStream& stream) {
      return stream.index == demuxer_->video().index || (options_.data_packets && IsDataStream(stream));
    });
  }

  /// Decodes the first frame, which determines the sizes.
  Status Start();

  [[nodiscard]] const VideoInfo& info() const override { return info_; }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& cancel, const ByteProgress& progress) const override;
  Expected<std::optional<Frame>> NextFrame() override;
  std::vector<DataPacket> TakeDataPackets() override { return data_.Take(clock_.origin_s(), joints_); }
  bool SeekTo(double time_s) override;
  void SkipToEnd() override;
  [[nodiscard]] std::optional<std::int64_t> ArrivalUtc(double time_s) const override;
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return damage_.lines(); }
  [[nodiscard]] const std::vector<std::string>& notes() const override { return damage_.notes(); }

 private:
  bool DecodeNext();
  bool Decode(AVFrame* frame);
  [[nodiscard]] std::optional<std::int64_t> TimeStamp(const AVFrame& frame) const;
  std::optional<std::int64_t> NextStamp();
  double ComputeFrameTime();
  void LogFrameDamage(double time_s);
  void FeedDecoder();
  bool ReadPacket();
  int ReadVideoPacket(AVPacket* packet);
  void DecideTimeBase();
  void LogMarkedPacket();
  void SendPacket();
  void StopReading(int result);
  void Finish();
  void LogPrematureEnd(std::string_view what, double end_s);
  void UpdatePacketsEnd();
  [[nodiscard]] std::optional<double> EndOfPackets() const;
  cv::Size SquareSize();
  void FillInfo(Orientation orientation, cv::Size size);
  [[nodiscard]] Orientation DisplayOrientation() const;
  [[nodiscard]] std::optional<double> ContainerDuration() const;
  [[nodiscard]] std::optional<double> VideoDuration() const;
  [[nodiscard]] double UndecodableLead() const;
  [[nodiscard]] bool IsVideoDuration() const;
  [[nodiscard]] double PacketTime() const;
  [[nodiscard]] std::int64_t StampFromTime(double time_s) const;

  MediaSource source_;
  VideoReaderOptions options_;
  std::unique_ptr<Demuxer> demuxer_;
  CodecHandle decoder_;
  PacketHandle packet_;
  PacketHandle packet_after_;  ///< the next packet of the video; valid if has_packet_after_
  bool has_packet_after_ = false;
  int read_end_ = 0;                     ///< FFmpeg's result at the end of the packets, once it was met
  std::optional<double> marked_time_s_;  ///< of a packet that the container marks as damaged, until it is logged
  FrameHandle frame_;                    ///< the current frame
  FrameHandle lookahead_;                ///< the next frame; valid if has_lookahead_
  bool has_lookahead_ = false;
  FrameClock clock_;
  LiveDelay arrival_;  ///< by time stamps
  DamageLog damage_;
  DataTrack data_;
  TimeBaseJoints joints_;
  std::optional<FrameConverter> converter_;
  std::optional<FrameConverter> color_converter_;  ///< of Frame::bgr
  cv::Size stored_size_;                           ///< size of the first frame, px
  bool has_time_stamps_;                           ///< the container has time stamps
  VideoInfo info_;
  std::optional<double> first_time_s_;  ///< time of the frame that Start() decoded, until it is delivered
  bool draining_ = false;               ///< true if no packets are left
  bool finished_ = false;
  std::string stop_reason_;  ///< reason for a premature end of the packets; empty at the regular end
  std::int64_t next_index_ = 0;
  std::optional<double> first_packet_s_;     ///< earliest time of the video's packets read so far, as stored
  std::optional<double> packets_end_ticks_;  ///< latest end of the video's packets read so far, stream time base
  bool has_unstamped_packets_ = false;       ///< true if one of them has no time stamp
};

Status MediaReader::Start() {
  if (!packet_ || !packet_after_ || !frame_ || !lookahead_)
    return Fail(ErrorCode::kInternal, fmt::format("{}: no memory for a frame", source_.name));
  if (!DecodeNext()) {
    const std::string reason = damage_.lines().empty() ? stop_reason_ : damage_.lines().front();
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: no frame of its video can be decoded{}{}", source_.name,
                                                  reason.empty() ? "" : ": ", reason));
  }
  first_time_s_ = ComputeFrameTime();
  const Orientation orientation = DisplayOrientation();
  stored_size_ = {frame_->width, frame_->height};
  const cv::Size size = SquareSize();
  const bool is_both = options_.color == FrameColor::kGreyAndBgr;
  converter_.emplace(is_both ? FrameColor::kGrey : options_.color, orientation, size);
  if (is_both) color_converter_.emplace(FrameColor::kBgr, orientation, size);
  FillInfo(orientation, size);
  if (const double lead_s = UndecodableLead(); lead_s > 0) {
    damage_.AddNote(fmt::format("begins without a key frame: its first {:.2f} s cannot be shown", lead_s));
  }
  return {};
}

Expected<std::string> MediaReader::ContentId(const CancelToken& cancel, const ByteProgress& progress) const {
  if (!source_.remote) return victorious::ContentId(source_.name, cancel, progress);
  if (const std::int64_t size = demuxer_->size_bytes(); !info_.live && size > 0) {
    return fmt::format("url {} {} bytes", source_.name, size);
  }
  if (!info_.live) return fmt::format("url {} {:.3f} s", source_.name, info_.duration_s.value_or(0));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return fmt::format("live {} {}", source_.name, std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

Expected<std::optional<Frame>> MediaReader::NextFrame() {
  while (first_time_s_ || DecodeNext()) {
    const double time_s = first_time_s_ ? *std::exchange(first_time_s_, std::nullopt) : ComputeFrameTime();
    LogFrameDamage(time_s);
    auto image = converter_->Convert(*frame_);
    if (next_index_ == 0 && image) {
      if (auto note = converter_->DescribeRange()) damage_.AddNote(*std::move(note));
    }
    Expected<cv::Mat> bgr;
    if (image && color_converter_) bgr = color_converter_->Convert(*frame_);
    if (!bgr) image = std::unexpected(bgr.error());
    if (image) {
      return Frame{.index = next_index_++, .time_s = time_s, .image = *std::move(image), .bgr = *std::move(bgr)};
    }
    if (next_index_ == 0) return std::unexpected(std::move(image).error().WithContext(source_.name));
    damage_.Add(image.error().message, time_s);
  }
  Finish();
  return std::nullopt;
}

// Moves the next frame to frame_. Returns false at the end.
bool MediaReader::DecodeNext() {
  if (!std::exchange(has_lookahead_, false)) return Decode(frame_.get());
  std::swap(frame_, lookahead_);
  return true;
}

bool MediaReader::Decode(AVFrame* frame) {
  for (int errors = 0; errors < kMaxDecodeErrors;) {
    const int result = avcodec_receive_frame(decoder_.get(), frame);
    if (result == 0) return true;
    if (result == AVERROR_EOF || (result == AVERROR(EAGAIN) && draining_)) return false;
    if (result == AVERROR(EAGAIN)) {
      FeedDecoder();
      errors = 0;
    } else {
      damage_.Add(fmt::format("a frame cannot be decoded ({})", FfmpegErrorText(result)), clock_.end_time_s());
      ++errors;
    }
  }
  return false;
}

std::optional<std::int64_t> MediaReader::TimeStamp(const AVFrame& frame) const {
  if (!has_time_stamps_ || frame.best_effort_timestamp == AV_NOPTS_VALUE) return std::nullopt;
  return frame.best_effort_timestamp;
}

std::optional<std::int64_t> MediaReader::NextStamp() {
  has_lookahead_ = has_lookahead_ || Decode(lookahead_.get());
  return has_lookahead_ ? TimeStamp(*lookahead_) : std::nullopt;
}

// The time of frame_.
double MediaReader::ComputeFrameTime() {
  const double duration_s = static_cast<double>(frame_->pkt_duration) * av_q2d(demuxer_->video().time_base);
  const auto reading = clock_.Next(TimeStamp(*frame_), duration_s, [&] { return NextStamp(); });
  if (reading.repaired) {
    damage_.Add("a damaged time stamp, replaced by the previous frame's time plus a duration", reading.time_s);
  }
  return reading.time_s;
}

void MediaReader::LogFrameDamage(double time_s) {
  if ((frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0) {
    damage_.Add("a frame is partly damaged", time_s);
  }
  if (cv::Size(frame_->width, frame_->height) != stored_size_) {
    damage_.Add(
        fmt::format("the size of a frame differs from the first; it is scaled to {} x {}", info_.width, info_.height),
        time_s);
  }
}

// Reads the next packet of the video and sends it to the decoder.
void MediaReader::FeedDecoder() {
  if (ReadPacket()) SendPacket();
}

std::optional<std::int64_t> MediaReader::ArrivalUtc(double time_s) const {
  const auto origin_s = clock_.origin_s();
  if (!info_.live || !origin_s) return std::nullopt;
  return arrival_.ArrivalUtc(time_s + *origin_s);
}

bool MediaReader::SeekTo(double time_s) {
  constexpr double kReordering_s = 1;  // bound of the reordering between decoding and presentation order, s
  const auto origin_s = clock_.origin_s();
  if (source_.remote || !has_time_stamps_ || !origin_s || damage_.has_damage()) return false;
  if (time_s <= kReordering_s) return false;  // FFmpeg seeks in MPEG-TS only from the second key frame on
  if (demuxer_->SeekBefore(StampFromTime(time_s - kReordering_s)) < 0) return false;
  avcodec_flush_buffers(decoder_.get());
  first_time_s_.reset();
  has_lookahead_ = draining_ = finished_ = has_packet_after_ = false;
  av_packet_unref(packet_after_.get());
  read_end_ = 0;
  joints_.Restart();
  clock_.Restart();
  return true;
}

std::int64_t MediaReader::StampFromTime(double time_s) const {
  const double ticks = (time_s + clock_.origin_s().value_or(0)) / av_q2d(demuxer_->video().time_base);
  return static_cast<std::int64_t>(std::clamp(std::floor(ticks), -1e18, 1e18));
}

void MediaReader::SkipToEnd() {
  while (ReadPacket()) av_packet_unref(packet_.get());
  first_time_s_.reset();
  has_lookahead_ = false;
  avcodec_flush_buffers(decoder_.get());
  const std::optional<double> end_s = EndOfPackets();
  if (!std::exchange(finished_, true) && end_s) LogPrematureEnd("reading", *end_s);
}

// Reads the next packet of the video into packet_. Returns false at the end.
bool MediaReader::ReadPacket() {
  if (draining_) return false;
  int result = 0;
  if (std::exchange(has_packet_after_, false)) {
    std::swap(packet_, packet_after_);
  } else {
    result = read_end_ < 0 ? read_end_ : ReadVideoPacket(packet_.get());
  }
  if (result < 0) {
    LogMarkedPacket();
    StopReading(result);
    return false;
  }
  if (has_time_stamps_ && joints_.IsOutOfOrder(*packet_)) DecideTimeBase();
  LogMarkedPacket();
  joints_.Move(*packet_);
  UpdatePacketsEnd();
  if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0) marked_time_s_ = PacketTime();
  return true;
}

// Reads up to the next packet of the video. Returns FFmpeg's result at the end.
int MediaReader::ReadVideoPacket(AVPacket* packet) {
  for (int errors = 0;;) {
    const int result = demuxer_->Read(packet);
    if (result == AVERROR_INVALIDDATA && ++errors <= kMaxReadErrors) {
      damage_.Add("a part of the container cannot be read", EndOfPackets().value_or(clock_.end_time_s()));
    } else if (result == AVERROR(EAGAIN) && ++errors <= kMaxReadErrors) {
      std::this_thread::sleep_for(kRetryPause);
    } else if (result < 0) {
      return result;
    } else if (packet->stream_index == demuxer_->video().index) {
      return 0;
    } else {
      const AVStream& stream = demuxer_->stream(packet->stream_index);
      if (options_.data_packets && IsDataStream(stream)) data_.Add(stream, *packet, joints_.count());
      av_packet_unref(packet);
    }
  }
}

// Decides whether packet_, which is out of order, begins another time base or has a damaged stamp.
void MediaReader::DecideTimeBase() {
  if (has_packet_after_ || read_end_ < 0) return;
  read_end_ = ReadVideoPacket(packet_after_.get());
  has_packet_after_ = read_end_ == 0;
  if (!has_packet_after_ || !joints_.EnterIfJoint(*packet_, *packet_after_)) return;
  // The container counts its packets anew: that one is missing is no damage.
  marked_time_s_.reset();
  damage_.AddLine(
      fmt::format("at {:.2f} s: the time stamps begin anew, as where recordings are joined: what comes "
                  "then, with its telemetry, follows what was before",
                  EndOfPackets().value_or(clock_.end_time_s())));
}

// Logs the previous packet of the video if the container marks it as damaged.
void MediaReader::LogMarkedPacket() {
  if (const auto time_s = std::exchange(marked_time_s_, std::nullopt)) {
    damage_.Add("a packet is marked as damaged by the container", *time_s);
  }
}

void MediaReader::SendPacket() {
  const int result = avcodec_send_packet(decoder_.get(), packet_.get());
  if (result < 0 && result != AVERROR(EAGAIN) && result != AVERROR_EOF) {
    damage_.Add(fmt::format("a packet cannot be decoded ({})", FfmpegErrorText(result)), PacketTime());
  }
  av_packet_unref(packet_.get());
}

void MediaReader::StopReading(int result) {
  draining_ = true;
  avcodec_send_packet(decoder_.get(), nullptr);
  if (result == AVERROR_EXIT) {
    stop_reason_ = fmt::format("the source sent nothing for {:g} s", source_.timeout_s);
  } else if (result != AVERROR_EOF) {
    stop_reason_ = FfmpegErrorText(result);
  }
}

void MediaReader::Finish() {
  if (!std::exchange(finished_, true)) LogPrematureEnd("decoding", clock_.end_time_s());
}

// Logs a premature end: end_s is clearly before the duration, or a stop reason is set.
void MediaReader::LogPrematureEnd(std::string_view what, double end_s) {
  const double rate = info_.frame_rate > 0 ? info_.frame_rate : 10;
  const double tolerance_s = std::max(IsVideoDuration() ? 0.25 : 1.0, 2.5 / rate);
  const bool ends_early = info_.duration_s && !info_.is_duration_estimated && end_s + tolerance_s < *info_.duration_s;
  if (!ends_early && stop_reason_.empty()) return;
  const std::string of = info_.duration_s ? fmt::format(" of {:.2f} s", *info_.duration_s) : "";
  damage_.AddLine(fmt::format("{} stopped at {:.2f} s{}: {}", what, end_s, of,
                              stop_reason_.empty() ? "the rest is missing or damaged" : stop_reason_));
}

// Size of the first frame after resampling to square pixels.
cv::Size MediaReader::SquareSize() {
  constexpr double kNearlySquare = 0.005;  // tolerance of a rounded ratio: not resampled
  constexpr double kMaxAspect = 10;
  const AVRational ratio = av_guess_sample_aspect_ratio(nullptr, &demuxer_->video(), frame_.get());
  if (ratio.num <= 0 || ratio.den <= 0 || std::abs(av_q2d(ratio) - 1) < kNearlySquare) return stored_size_;
  const double aspect = av_q2d(ratio);
  const double width = std::round(stored_size_.width * aspect);
  if (aspect > kMaxAspect || aspect < 1 / kMaxAspect || width < 1 || width * stored_size_.height > kMaxFramePixels) {
    damage_.AddLine(
        fmt::format("pixels of {}:{} are beyond 10:1 or the size limit; they stay as stored", ratio.num, ratio.den));
    return stored_size_;
  }
  info_.pixel_aspect = aspect;
  return {static_cast<int>(width), stored_size_.height};
}

void MediaReader::FillInfo(Orientation orientation, cv::Size size) {
  const AVStream& video = demuxer_->video();
  info_.container = demuxer_->container().iformat->name;
  info_.codec = avcodec_get_name(video.codecpar->codec_id);
  info_.width = SwapsWidthAndHeight(orientation) ? size.height : size.width;
  info_.height = SwapsWidthAndHeight(orientation) ? size.width : size.height;
  info_.rotation_deg = ClockwiseRotationDeg(orientation);
  info_.frame_rate = FrameRate(video);
  info_.live = demuxer_->IsLive();
  if (info_.live) info_.live_since = demuxer_->analysed_since();
  info_.duration_s = VideoDuration();
  info_.is_duration_estimated = demuxer_->container().duration_estimation_method == AVFMT_DURATION_FROM_BITRATE;
  if (video.nb_frames > 0) {
    info_.frame_count = video.nb_frames;
  } else if (info_.duration_s && info_.frame_rate > 0) {
    info_.frame_count = std::llround(*info_.duration_s * info_.frame_rate);
  }
  for (unsigned i = 0; i < demuxer_->container().nb_streams; ++i) {
    const AVStream& stream = demuxer_->stream(static_cast<int>(i));
    info_.streams.push_back({stream.index, TypeOf(stream), CodecName(stream)});
  }
}

// Orientation from the container, or else from the video stream (H.264 and H.265: an SEI message).
Orientation MediaReader::DisplayOrientation() const {
  constexpr std::size_t kMatrixBytes = 9 * sizeof(std::int32_t);
  std::size_t size = 0;
  const std::uint8_t* data = av_stream_get_side_data(&demuxer_->video(), AV_PKT_DATA_DISPLAYMATRIX, &size);
  if (data == nullptr) {
    if (const AVFrameSideData* side = av_frame_get_side_data(frame_.get(), AV_FRAME_DATA_DISPLAYMATRIX)) {
      data = side->data;
      size = side->size;
    }
  }
  if (data == nullptr || size < kMatrixBytes) return Orientation::kUpright;
  std::array<std::int32_t, 9> matrix{};
  std::memcpy(matrix.data(), data, kMatrixBytes);
  return OrientationFromDisplayMatrix(matrix);
}

// How much later than the packets of the video its first frame begins, s: those before the first key frame are not
// decoded. 0 where it is no more than the pictures that are stored after a key frame and shown before it.
double MediaReader::UndecodableLead() const {
  const auto origin_s = clock_.origin_s();
  if (source_.remote || !origin_s || !has_time_stamps_ || !first_packet_s_) return 0;
  const double lead_s = *origin_s - *first_packet_s_;
  const double rate = info_.frame_rate > 0 ? info_.frame_rate : 10;
  return lead_s > std::max(0.25, 2.5 / rate) ? lead_s : 0;
}

std::optional<double> MediaReader::VideoDuration() const {
  const auto duration_s = ContainerDuration();
  return duration_s && *duration_s > UndecodableLead() ? std::optional(*duration_s - UndecodableLead()) : duration_s;
}

std::optional<double> MediaReader::ContainerDuration() const {
  const AVStream& video = demuxer_->video();
  const AVFormatContext& container = demuxer_->container();
  const double rate = FrameRate(video);
  // For a truncated AVI, FFmpeg derives the duration from the available part; the header has the full frame count.
  if (std::string_view(container.iformat->name) == "avi" && video.nb_frames > 0 && rate > 0) {
    return static_cast<double>(video.nb_frames) / rate;
  }
  if (video.duration > 0) return static_cast<double>(video.duration) * av_q2d(video.time_base);
  std::int64_t duration = container.duration;
  // Matroska's duration is the end time of the last frame; the first frame need not start at 0.
  const bool duration_is_end_time = std::string_view(container.iformat->name).starts_with("matroska");
  if (duration_is_end_time && container.start_time > 0) duration -= container.start_time;
  if (duration > 0) return static_cast<double>(duration) / AV_TIME_BASE;
  return std::nullopt;
}

// False if only the container has a duration and there is audio: it may be the duration of the audio.
bool MediaReader::IsVideoDuration() const {
  if (demuxer_->video().duration > 0) return true;
  for (unsigned i = 0; i < demuxer_->container().nb_streams; ++i) {
    if (demuxer_->stream(static_cast<int>(i)).codecpar->codec_type == AVMEDIA_TYPE_AUDIO) return false;
  }
  return true;
}

double MediaReader::PacketTime() const {
  const auto origin_s = clock_.origin_s();
  if (!origin_s || packet_->pts == AV_NOPTS_VALUE) return clock_.end_time_s();
  return static_cast<double>(packet_->pts) * av_q2d(demuxer_->video().time_base) - *origin_s;
}

void MediaReader::UpdatePacketsEnd() {
  const std::int64_t stamp = packet_->pts != AV_NOPTS_VALUE ? packet_->pts : packet_->dts;
  if (source_.remote && stamp != AV_NOPTS_VALUE) {
    arrival_.EnterRead(static_cast<double>(stamp) * av_q2d(demuxer_->video().time_base), 0);
  }
  if (packet_->pts != AV_NOPTS_VALUE && (packet_->flags & AV_PKT_FLAG_DISCARD) == 0) {
    const double time_s = static_cast<double>(packet_->pts) * av_q2d(demuxer_->video().time_base);
    first_packet_s_ = std::min(time_s, first_packet_s_.value_or(time_s));
  }
  has_unstamped_packets_ = has_unstamped_packets_ || stamp == AV_NOPTS_VALUE;
  if (has_unstamped_packets_) return;
  const double end_ticks = static_cast<double>(stamp) + std::max(0.0, static_cast<double>(packet_->duration));
  packets_end_ticks_ = std::max(end_ticks, packets_end_ticks_.value_or(end_ticks));
}

// End time of the last frame read, decoded or not; std::nullopt if a packet has no time stamp.
std::optional<double> MediaReader::EndOfPackets() const {
  const auto origin_s = clock_.origin_s();
  if (!origin_s || has_unstamped_packets_ || !packets_end_ticks_) return std::nullopt;
  const double end_s = *packets_end_ticks_ * av_q2d(demuxer_->video().time_base) - *origin_s;
  return std::max(end_s, clock_.end_time_s());
}

}  // namespace

Expected<std::unique_ptr<VideoReader>> OpenMedia(const MediaSource& source, const VideoReaderOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<Demuxer> demuxer, Demuxer::Open(source));
  VICTORIOUS_ASSIGN_OR_RETURN(CodecHandle decoder, OpenDecoder(demuxer->video(), source, options.threads));
  auto reader = std::make_unique<MediaReader>(source, options, std::move(demuxer), std::move(decoder));
  VICTORIOUS_RETURN_IF_ERROR(reader->Start());
  return reader;
}

}  // namespace victorious
