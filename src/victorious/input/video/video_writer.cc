#include "victorious/input/video/video_writer.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "victorious/base/check.h"
#include "victorious/base/text.h"
#include "victorious/input/video/ffmpeg_handles.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace victorious {
namespace {

namespace fs = std::filesystem;

Expected<const char*> MuxerFor(const fs::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  if (extension == ".mp4") return "mp4";
  if (extension == ".mkv") return "matroska";
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: a video's name must end in .mp4 or .mkv", path.string()));
}

Status CheckOptions(const fs::path& path, const VideoWriterOptions& options) {
  const auto fail = [&](std::string_view what) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", path.string(), what));
  };
  constexpr int kMaxSide = 16384;  // x264's limit
  const auto bad_side = [](int side) { return side < 2 || side > kMaxSide || side % 2 != 0; };
  if (bad_side(options.width) || bad_side(options.height)) {
    return fail(fmt::format("{} x {} pixels: both must be even, 2 to {}", options.width, options.height, kMaxSide));
  }
  if (!(options.fps > 0 && options.fps <= 1000)) {
    return fail(fmt::format("{:g} frames/s: must be above 0, up to 1000", options.fps));
  }
  if (options.key_frame_interval < 1) return fail("the interval of key frames must be at least 1");
  if (options.crf < 0 || options.crf > 51) return fail(fmt::format("crf {}: must be 0 to 51", options.crf));
  return {};
}

class H264Writer : public VideoWriter {
 public:
  H264Writer(fs::path path, const VideoWriterOptions& options)
      : path_(std::move(path)),
        temporary_(path_.string() + TemporarySuffix()),
        options_(options),
        packet_(av_packet_alloc()),
        frame_(av_frame_alloc()) {}
  ~H264Writer() override { Discard(); }

  Status Start(const char* muxer);
  Status Write(const cv::Mat& image) override;
  Status WriteAt(const cv::Mat& image, double time_s) override;
  Status Finish() override;

 private:
  Status OpenEncoder(AVRational rate);
  Status OpenFile(const char* muxer, AVRational rate);
  Status FillFrame(const cv::Mat& image);
  Status WriteFrame(const cv::Mat& image, std::int64_t pts);
  Status Encode(const AVFrame* frame);
  [[nodiscard]] Status Sync() const;
  void Discard();
  [[nodiscard]] Status Check(int result, std::string_view verb) const;

  static std::string TemporarySuffix() {
    static std::atomic<unsigned> counter{0};
    return fmt::format(".tmp-{}-{}", ::getpid(), counter++);
  }

  fs::path path_;
  fs::path temporary_;
  VideoWriterOptions options_;
  CodecHandle encoder_;
  AVFormatContext* container_ = nullptr;  ///< null after Finish() or Discard()
  PacketHandle packet_;
  FrameHandle frame_;
  ScalerHandle scaler_;
  std::int64_t frames_ = 0;
  std::int64_t next_pts_ = 0;  ///< the earliest possible, in units of the encoder's time base
  std::int64_t duration_ = 1;  ///< of a packet, likewise
};

Status H264Writer::Start(const char* muxer) {
  const AVRational rate = av_d2q(options_.fps, 1'000'000);
  VICTORIOUS_RETURN_IF_ERROR(OpenEncoder(rate));
  frame_->format = encoder_->pix_fmt;
  frame_->width = encoder_->width;
  frame_->height = encoder_->height;
  VICTORIOUS_RETURN_IF_ERROR(Check(av_frame_get_buffer(frame_.get(), 0), "encode"));
  return OpenFile(muxer, rate);
}

Status H264Writer::OpenEncoder(AVRational rate) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (codec == nullptr) return Fail(ErrorCode::kUnsupported, "FFmpeg was built without the encoder libx264");
  encoder_.reset(avcodec_alloc_context3(codec));
  encoder_->width = options_.width;
  encoder_->height = options_.height;
  encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder_->color_range = AVCOL_RANGE_MPEG;
  encoder_->colorspace = AVCOL_SPC_SMPTE170M;
  constexpr AVRational kFineTimeBase = {1, 90'000};
  encoder_->time_base = options_.timed ? kFineTimeBase : av_inv_q(rate);
  duration_ = std::max<std::int64_t>(1, av_rescale_q(1, av_inv_q(rate), encoder_->time_base));
  encoder_->framerate = rate;
  encoder_->gop_size = options_.key_frame_interval;
  // B-frames would shift the times of decoding, whose steps add up to the duration that the container gives.
  if (options_.timed) encoder_->max_b_frames = 0;
  encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(encoder_->priv_data, "preset", "fast", 0);
  av_opt_set_double(encoder_->priv_data, "crf", options_.crf, 0);
  // The macroblock tree of x264 164 reads uninitialised memory (with AVX-512), which makes the output
  // non-deterministic.
  av_opt_set(encoder_->priv_data, "x264-params", "mbtree=0", 0);
  return Check(avcodec_open2(encoder_.get(), codec, nullptr), "encode");
}

Status H264Writer::OpenFile(const char* muxer, AVRational rate) {
  VICTORIOUS_RETURN_IF_ERROR(Check(avformat_alloc_output_context2(&container_, nullptr, muxer, nullptr), "create"));
  AVStream* stream = avformat_new_stream(container_, nullptr);
  if (stream == nullptr) return Fail(ErrorCode::kInternal, "no memory for a video stream");
  stream->time_base = encoder_->time_base;
  stream->avg_frame_rate = rate;
  VICTORIOUS_RETURN_IF_ERROR(Check(avcodec_parameters_from_context(stream->codecpar, encoder_.get()), "create"));
  const std::string url = "file:" + temporary_.string();
  VICTORIOUS_RETURN_IF_ERROR(Check(avio_open(&container_->pb, url.c_str(), AVIO_FLAG_WRITE), "create"));
  return Check(avformat_write_header(container_, nullptr), "write");
}

Status H264Writer::Write(const cv::Mat& image) {
  VICTORIOUS_CHECK(!options_.timed);
  return WriteFrame(image, next_pts_);
}

Status H264Writer::WriteAt(const cv::Mat& image, double time_s) {
  VICTORIOUS_CHECK(options_.timed);
  constexpr double kMaxTime_s = 1e9;
  const double pts = time_s / av_q2d(encoder_->time_base);
  if (!(time_s >= 0 && time_s <= kMaxTime_s) || std::llround(pts) < next_pts_) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: frame {} at {:g} s: must be later than the frame before",
                                                         path_.string(), frames_, time_s));
  }
  // MP4 has 32 bits for the duration of a frame.
  if (frames_ > 0 && std::llround(pts) - next_pts_ >= INT32_MAX) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: frame {} at {:g} s: comes too late after the frame before: {:.1f} hours are the most",
                            path_.string(), frames_, time_s, INT32_MAX * av_q2d(encoder_->time_base) / 3600));
  }
  return WriteFrame(image, std::llround(pts));
}

Status H264Writer::WriteFrame(const cv::Mat& image, std::int64_t pts) {
  if (container_ == nullptr) return Fail(ErrorCode::kInternal, fmt::format("{}: already finished", path_.string()));
  if (image.cols != options_.width || image.rows != options_.height ||
      (image.type() != CV_8UC1 && image.type() != CV_8UC3)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: frame {} is {} x {} of type {}; it must be {} x {}, 8-bit grey or BGR", path_.string(),
                    frames_, image.cols, image.rows, cv::typeToString(image.type()), options_.width, options_.height));
  }
  VICTORIOUS_RETURN_IF_ERROR(FillFrame(image));
  frame_->pts = pts;
  next_pts_ = pts + 1;
  ++frames_;
  return Encode(frame_.get());
}

// Limited range, BT.601: the default that all players assume.
Status H264Writer::FillFrame(const cv::Mat& image) {
  VICTORIOUS_RETURN_IF_ERROR(Check(av_frame_make_writable(frame_.get()), "encode"));
  const AVPixelFormat format = image.type() == CV_8UC1 ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_BGR24;
  scaler_.reset(sws_getCachedContext(scaler_.release(), image.cols, image.rows, format, image.cols, image.rows,
                                     AV_PIX_FMT_YUV420P, SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
  if (!scaler_) return Fail(ErrorCode::kInternal, fmt::format("{}: no colour conversion", path_.string()));
  const int* bt601 = sws_getCoefficients(SWS_CS_ITU601);
  constexpr int kOne = 1 << 16;  // 16.16 fixed point
  sws_setColorspaceDetails(scaler_.get(), bt601, 1, bt601, 0, 0, kOne, kOne);
  const std::uint8_t* const planes[] = {image.data};
  const int strides[] = {static_cast<int>(image.step)};
  return Check(sws_scale(scaler_.get(), planes, strides, 0, image.rows, frame_->data, frame_->linesize), "encode");
}

// Sends a frame to the encoder (nullptr: flushes it) and writes the available packets.
Status H264Writer::Encode(const AVFrame* frame) {
  VICTORIOUS_RETURN_IF_ERROR(Check(avcodec_send_frame(encoder_.get(), frame), "encode"));
  while (true) {
    const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
    if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return {};
    VICTORIOUS_RETURN_IF_ERROR(Check(result, "encode"));
    const AVStream& stream = *container_->streams[0];
    packet_->duration = duration_;
    packet_->stream_index = stream.index;
    av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream.time_base);
    VICTORIOUS_RETURN_IF_ERROR(Check(av_interleaved_write_frame(container_, packet_.get()), "write"));
  }
}

Status H264Writer::Finish() {
  if (container_ == nullptr) return Fail(ErrorCode::kInternal, fmt::format("{}: already finished", path_.string()));
  if (frames_ == 0) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: a video needs at least one frame", path_.string()));
  }
  VICTORIOUS_RETURN_IF_ERROR(Encode(nullptr));
  VICTORIOUS_RETURN_IF_ERROR(Check(av_write_trailer(container_), "write"));
  VICTORIOUS_RETURN_IF_ERROR(Check(avio_closep(&container_->pb), "write"));
  VICTORIOUS_RETURN_IF_ERROR(Sync());
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), fmt::format("rename to {}", path_.string())));
  avformat_free_context(std::exchange(container_, nullptr));
  return {};
}

// Flushes the file to disk before the rename, so that a crash leaves no partial file under the final name.
Status H264Writer::Sync() const {
  const int fd = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const int result = fd < 0 ? -1 : ::fsync(fd);
  const int error = errno;
  if (fd >= 0) ::close(fd);
  return Check(result < 0 ? AVERROR(error) : 0, "write");
}

void H264Writer::Discard() {
  if (container_ == nullptr) return;
  if (container_->pb != nullptr) avio_closep(&container_->pb);
  avformat_free_context(std::exchange(container_, nullptr));
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

Status H264Writer::Check(int result, std::string_view verb) const {
  if (result >= 0) return {};
  const std::string what = fmt::format("{} {}", verb, path_.string());
  if (result > -1000) return std::unexpected(ErrorFromErrno(AVUNERROR(result), what));  // an errno, not a tag
  return Fail(ErrorCode::kInternal, fmt::format("{}: {}", what, FfmpegErrorText(result)));
}

}  // namespace

Expected<std::unique_ptr<VideoWriter>> VideoWriter::Create(const fs::path& path, const VideoWriterOptions& options) {
  PrepareFfmpeg();
  VICTORIOUS_ASSIGN_OR_RETURN(const char* muxer, MuxerFor(path));
  VICTORIOUS_RETURN_IF_ERROR(CheckOptions(path, options));
  auto writer = std::make_unique<H264Writer>(path, options);
  VICTORIOUS_RETURN_IF_ERROR(writer->Start(muxer));
  return writer;
}

}  // namespace victorious
