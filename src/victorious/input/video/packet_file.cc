#include "victorious/input/video/packet_file.h"

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace victorious {

namespace fs = std::filesystem;

PacketFile::~PacketFile() {
  if (container_ == nullptr) return;
  if (container_->pb != nullptr) avio_closep(&container_->pb);
  avformat_free_context(container_);
  std::error_code ignored;
  if (flush_ == PacketFlush::kBuffered) fs::remove(temporary_, ignored);
}

Status PacketFile::Open(const char* muxer, std::span<const AVStream* const> sources, PacketFlush flush) {
  flush_ = flush;
  VICTORIOUS_RETURN_IF_ERROR(Check(avformat_alloc_output_context2(&container_, nullptr, muxer, nullptr), "create"));
  for (const AVStream* const source : sources) {
    AVStream* stream = avformat_new_stream(container_, nullptr);
    if (stream == nullptr) return Fail(ErrorCode::kInternal, "no memory for a stream");
    VICTORIOUS_RETURN_IF_ERROR(Check(avcodec_parameters_copy(stream->codecpar, source->codecpar), "create"));
    stream->codecpar->codec_tag = 0;  // of the source's container
    stream->time_base = source->time_base;
    stream->avg_frame_rate = source->avg_frame_rate;
  }
  if (flush_ == PacketFlush::kAtOnce) container_->flags |= AVFMT_FLAG_FLUSH_PACKETS;
  const std::string url = "file:" + temporary_.string();
  VICTORIOUS_RETURN_IF_ERROR(Check(avio_open(&container_->pb, url.c_str(), AVIO_FLAG_WRITE), "create"));
  return Check(avformat_write_header(container_, nullptr), "write");
}

// Packets come in the order of time: FFmpeg need not hold them until each stream has some.
Status PacketFile::Write(AVPacket& packet, int stream, AVRational time_base) {
  packet.stream_index = stream;
  packet.pos = -1;
  av_packet_rescale_ts(&packet, time_base, container_->streams[stream]->time_base);
  return Check(av_write_frame(container_, &packet), "write");
}

Status PacketFile::Rename(fs::path path, fs::path temporary) {
  std::error_code error;
  fs::rename(temporary_, temporary, error);
  VICTORIOUS_RETURN_IF_ERROR(Check(error ? AVERROR(error.value()) : 0, "rename"));
  path_ = std::move(path);
  temporary_ = std::move(temporary);
  return {};
}

Status PacketFile::Finish() {
  VICTORIOUS_RETURN_IF_ERROR(Check(av_write_trailer(container_), "write"));
  VICTORIOUS_RETURN_IF_ERROR(Check(avio_closep(&container_->pb), "write"));
  // Before the rename, so that a crash leaves no partial file under the final name.
  const int fd = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const int result = fd < 0 ? -1 : ::fsync(fd);
  const int failure = errno;
  if (fd >= 0) ::close(fd);
  VICTORIOUS_RETURN_IF_ERROR(Check(result < 0 ? AVERROR(failure) : 0, "write"));
  std::error_code error;
  fs::rename(temporary_, path_, error);
  return Check(error ? AVERROR(error.value()) : 0, "rename to");
}

Status PacketFile::Check(int result, std::string_view verb) const {
  if (result >= 0) return {};
  const std::string what = fmt::format("{} {}", verb, path_.string());
  if (result > -1000) return std::unexpected(ErrorFromErrno(AVUNERROR(result), what));  // an errno, not a tag
  return Fail(ErrorCode::kInternal, fmt::format("{}: {}", what, FfmpegErrorText(result)));
}

}  // namespace victorious
