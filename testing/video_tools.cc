#include "testing/video_tools.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/input/video/ffmpeg_handles.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

namespace victorious::testing {
namespace {

constexpr int kNumberBits = 8;

cv::Rect NumberField(cv::Size size, int bit) {
  const int left = size.width * bit / kNumberBits;
  return {left, 0, size.width * (bit + 1) / kNumberBits - left, size.height / 4};
}

void Check(int result) {
  if (result < 0) std::fprintf(stderr, "FFmpeg: %s\n", FfmpegErrorText(result).c_str());
  VICTORIOUS_CHECK(result >= 0);
}

class Muxer {
 public:
  Muxer(const std::filesystem::path& path, const TestVideo& video) : video_(video) {
    PrepareFfmpeg();
    Check(avformat_alloc_output_context2(&container_, nullptr, video.muxer.c_str(), ("file:" + path.string()).c_str()));
    Check(avio_open(&container_->pb, ("file:" + path.string()).c_str(), AVIO_FLAG_WRITE));
  }
  ~Muxer() {
    Check(avio_closep(&container_->pb));
    avformat_free_context(container_);
  }
  Muxer(const Muxer&) = delete;
  Muxer& operator=(const Muxer&) = delete;

  void Write() {
    if (video_.video) AddVideo();
    if (video_.audio) AddAudio();
    if (video_.cover) AddCover();
    const AVCodecID klv = video_.names_klv ? AV_CODEC_ID_SMPTE_KLV : AV_CODEC_ID_BIN_DATA;
    if (!video_.klv.empty()) AddData(AVMEDIA_TYPE_DATA, klv, video_.klv);
    if (!video_.subtitles.empty()) AddData(AVMEDIA_TYPE_SUBTITLE, AV_CODEC_ID_SUBRIP, video_.subtitles);
    AVDictionary* options = nullptr;
    if (video_.muxer == "mp4") av_dict_set(&options, "movflags", "+faststart", 0);
    Check(avformat_write_header(container_, &options));
    av_dict_free(&options);
    WritePackets();
    Check(av_write_trailer(container_));
  }

 private:
  struct Waiting {
    PacketHandle packet;
    AVRational time_base;
    std::size_t place;
  };

  AVStream& AddStream() {
    AVStream* stream = avformat_new_stream(container_, nullptr);
    VICTORIOUS_CHECK(stream != nullptr);
    return *stream;
  }

  CodecHandle NewEncoder(const std::string& name) {
    const AVCodec* codec = avcodec_find_encoder_by_name(name.c_str());
    VICTORIOUS_CHECK(codec != nullptr);
    CodecHandle encoder(avcodec_alloc_context3(codec));
    if ((container_->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    return encoder;
  }

  void Encode(AVCodecContext& encoder, const AVFrame* frame, int stream) {
    Check(avcodec_send_frame(&encoder, frame));
    while (true) {
      PacketHandle packet(av_packet_alloc());
      const int result = avcodec_receive_packet(&encoder, packet.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
      Check(result);
      packet->stream_index = stream;
      waiting_.push_back({std::move(packet), encoder.time_base, waiting_.size()});
    }
  }

  void AddVideo() {
    const CodecHandle encoder = NewEncoder(video_.encoder);
    encoder->width = video_.size.width;
    encoder->height = video_.size.height;
    encoder->pix_fmt = av_get_pix_fmt(video_.pixel_format.c_str());
    encoder->color_range = video_.full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    encoder->colorspace = static_cast<AVColorSpace>(video_.color_space);
    encoder->sample_aspect_ratio = {video_.pixel_aspect.width, video_.pixel_aspect.height};
    encoder->time_base = {1, video_.time_base_hz};
    const auto step = video_.pts.size() > 1 ? static_cast<int>(video_.pts[1] - video_.pts[0]) : 1;
    encoder->framerate = {video_.time_base_hz, step};
    encoder->gop_size = video_.key_frame_interval;
    encoder->max_b_frames = video_.max_b_frames;
    encoder->bit_rate = 4'000'000;
    encoder->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
    if (video_.encoder == "libx264") av_opt_set(encoder->priv_data, "crf", "12", 0);
    Check(avcodec_open2(encoder.get(), nullptr, nullptr));
    AVStream& stream = AddStream();
    stream.time_base = encoder->time_base;
    stream.avg_frame_rate = encoder->framerate;
    stream.sample_aspect_ratio = encoder->sample_aspect_ratio;
    Check(avcodec_parameters_from_context(stream.codecpar, encoder.get()));
    if (video_.rotation_deg != 0) {
      auto* matrix = av_stream_new_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(std::int32_t));
      av_display_rotation_set(reinterpret_cast<std::int32_t*>(matrix), video_.rotation_deg);
    }
    for (std::size_t i = 0; i < video_.pts.size(); ++i) {
      const cv::Mat image =
          video_.images.empty() ? NumberedImage(static_cast<int>(i % 256), video_.size) : video_.images[i];
      const FrameHandle frame = ToFrame(image, *encoder);
      frame->pts = video_.pts[i];
      Encode(*encoder, frame.get(), stream.index);
    }
    Encode(*encoder, nullptr, stream.index);
  }

  FrameHandle ToFrame(const cv::Mat& bgr, const AVCodecContext& encoder) {
    FrameHandle frame(av_frame_alloc());
    frame->format = encoder.pix_fmt;
    frame->width = encoder.width;
    frame->height = encoder.height;
    frame->color_range = encoder.color_range;
    Check(av_frame_get_buffer(frame.get(), 0));
    const ScalerHandle scaler(sws_getContext(bgr.cols, bgr.rows, AV_PIX_FMT_BGR24, frame->width, frame->height,
                                             encoder.pix_fmt, SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr,
                                             nullptr));
    const int* matrix = sws_getCoefficients(encoder.colorspace);
    sws_setColorspaceDetails(scaler.get(), matrix, 1, matrix, video_.full_range ? 1 : 0, 0, 1 << 16, 1 << 16);
    const std::uint8_t* const planes[] = {bgr.data};
    const int strides[] = {static_cast<int>(bgr.step)};
    Check(sws_scale(scaler.get(), planes, strides, 0, bgr.rows, frame->data, frame->linesize));
    return frame;
  }

  // 0.5 s of silence.
  void AddAudio() {
    constexpr int kRate = 16000;
    const CodecHandle encoder = NewEncoder("aac");
    encoder->sample_rate = kRate;
    encoder->sample_fmt = AV_SAMPLE_FMT_FLTP;
    encoder->ch_layout = AV_CHANNEL_LAYOUT_MONO;
    encoder->time_base = {1, kRate};
    Check(avcodec_open2(encoder.get(), nullptr, nullptr));
    AVStream& stream = AddStream();
    stream.time_base = encoder->time_base;
    Check(avcodec_parameters_from_context(stream.codecpar, encoder.get()));
    for (int sample = 0; sample < kRate / 2; sample += encoder->frame_size) {
      const FrameHandle frame(av_frame_alloc());
      frame->format = encoder->sample_fmt;
      frame->nb_samples = encoder->frame_size;
      frame->sample_rate = kRate;
      Check(av_channel_layout_copy(&frame->ch_layout, &encoder->ch_layout));
      Check(av_frame_get_buffer(frame.get(), 0));
      std::fill_n(reinterpret_cast<float*>(frame->data[0]), frame->nb_samples, 0.0F);
      frame->pts = sample;
      Encode(*encoder, frame.get(), stream.index);
    }
    Encode(*encoder, nullptr, stream.index);
  }

  void AddCover() {
    std::vector<unsigned char> png;
    VICTORIOUS_CHECK(cv::imencode(".png", NumberedImage(255, {400, 300}), png));
    AVStream& stream = AddStream();
    stream.disposition = AV_DISPOSITION_ATTACHED_PIC;
    stream.codecpar->codec_type = AVMEDIA_TYPE_VIDEO;
    stream.codecpar->codec_id = AV_CODEC_ID_PNG;
    stream.codecpar->width = 400;
    stream.codecpar->height = 300;
    AddPacket(stream.index, 0, std::string(png.begin(), png.end()));
  }

  void AddData(AVMediaType type, AVCodecID codec, const std::vector<TestPacket>& packets) {
    AVStream& stream = AddStream();
    stream.codecpar->codec_type = type;
    stream.codecpar->codec_id = codec;
    stream.time_base = {1, video_.time_base_hz};
    for (const TestPacket& packet : packets) AddPacket(stream.index, packet.pts, packet.bytes);
  }

  void AddPacket(int stream, std::int64_t pts, const std::string& bytes) {
    PacketHandle packet(av_packet_alloc());
    Check(av_new_packet(packet.get(), static_cast<int>(bytes.size())));
    std::ranges::copy(bytes, packet->data);
    packet->stream_index = stream;
    packet->pts = packet->dts = pts;
    packet->duration = 1;
    packet->flags |= AV_PKT_FLAG_KEY;
    waiting_.push_back({std::move(packet), {1, video_.time_base_hz}, waiting_.size()});
  }

  // Interleaves the streams by decoding time; stable within a stream.
  void WritePackets() {
    const auto before = [](const Waiting& a, const Waiting& b) {
      const int order = av_compare_ts(a.packet->dts, a.time_base, b.packet->dts, b.time_base);
      return order != 0 ? order < 0 : a.place < b.place;
    };
    std::ranges::sort(waiting_, before);
    for (Waiting& waiting : waiting_) {
      AVPacket* packet = waiting.packet.get();
      av_packet_rescale_ts(packet, waiting.time_base, container_->streams[packet->stream_index]->time_base);
      Check(av_write_frame(container_, packet));
    }
  }

  const TestVideo& video_;
  AVFormatContext* container_ = nullptr;
  std::vector<Waiting> waiting_;
};

}  // namespace

cv::Mat NumberedImage(int number, cv::Size size) {
  cv::Mat image(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.at<cv::Vec3b>(y, x) = {cv::saturate_cast<uchar>(60 + 140.0 * x / size.width),
                                   cv::saturate_cast<uchar>(60 + 140.0 * y / size.height), 120};
    }
  }
  for (int bit = 0; bit < kNumberBits; ++bit) {
    image(NumberField(size, bit)).setTo((number >> bit & 1) != 0 ? cv::Scalar::all(230) : cv::Scalar::all(25));
  }
  return image;
}

int DecodeImageNumber(const cv::Mat& image) {
  int number = 0;
  for (int bit = 0; bit < kNumberBits; ++bit) {
    const cv::Scalar mean = cv::mean(image(NumberField(image.size(), bit)));
    if (mean[0] > 128) number |= 1 << bit;
  }
  return number;
}

void WriteTestVideo(const std::filesystem::path& path, const TestVideo& video) { Muxer(path, video).Write(); }

void BeginEditListAt(const std::filesystem::path& path, double begin_s) {
  std::string bytes = ReadBytes(path);
  const auto find = [&](const char* box) {
    const std::size_t at = bytes.find(box);
    VICTORIOUS_CHECK(at != std::string::npos && bytes[at + 4] == 0);  // version 0: 32-bit times
    return at + 8;                                                    // behind version and flags
  };
  const auto read = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  const auto write = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
  };
  const auto ticks = [&](const char* box) {
    return static_cast<std::uint32_t>(std::lround(begin_s * read(find(box) + 8)));
  };
  const std::size_t list = find("elst");
  VICTORIOUS_CHECK(read(list) == 1);                // entries: duration, media time, rate
  write(list + 4, read(list + 4) - ticks("mvhd"));  // of the whole
  write(list + 8, read(list + 8) + ticks("mdhd"));
  WriteBytes(path, bytes);
}

std::vector<std::int64_t> SteadyTimes(int count, std::int64_t step) {
  std::vector<std::int64_t> times;
  times.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) times.push_back(i * step);
  return times;
}

std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void WriteBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace victorious::testing
