#include "victorious/input/video/demuxer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <ranges>
#include <string_view>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/text.h"
#include "victorious/input/video/tls_verification.h"
#include "victorious/input/video/video_reader.h"

extern "C" {
#include <libavutil/dict.h>
}

namespace victorious {
namespace {

constexpr std::array<std::string_view, 12> kUrlSchemes = {"rtsp",  "rtsps", "rtp",   "udp",   "tcp", "http",
                                                          "https", "rtmp",  "rtmps", "rtmpt", "srt", "mmsh"};

// Formats accepted for a local file. Only self-contained containers: no playlists, manifests or session descriptions,
// which refer to other files, and no text art, which would accept any .txt file. Audio formats are included so that an
// audio file gives the error "no video stream".
#define VICTORIOUS_VIDEO_FILE_FORMATS                                                                                \
  "mov,matroska,mpegts,mpeg,mpegvideo,avi,flv,asf,ogg,mxf,gif,apng,ivf,h264,hevc,m4v,mjpeg,yuv4mpegpipe,nut,dv,vc1," \
  "obu,rm,wtv"
constexpr const char* kVideoFileFormats = VICTORIOUS_VIDEO_FILE_FORMATS;
constexpr const char* kFileFormats = VICTORIOUS_VIDEO_FILE_FORMATS ",mp3,wav,flac,aac";
#undef VICTORIOUS_VIDEO_FILE_FORMATS

// What an address may lead to. Whoever sends to an open port must not make this program fetch other addresses:
// playlists are read over HTTP only.
struct RemoteAccess {
  std::string_view schemes;  // separated by commas
  const char* protocols;     // as FFmpeg's protocol_whitelist
  const char* formats;       // as FFmpeg's format_whitelist
};

#define VICTORIOUS_STREAM_FORMATS                                                                                    \
  "mov,matroska,mpegts,mpeg,mpegvideo,avi,flv,live_flv,asf,ogg,mxf,ivf,h264,hevc,m4v,mjpeg,mpjpeg,nut,mp3,wav,flac," \
  "aac"
constexpr std::array<RemoteAccess, 6> kRemoteAccess = {{
    {"rtsp,rtsps", "rtsp,rtp,srtp,udp,tcp,tls", "rtsp,rtp,sdp,mpegts"},
    {"rtp", "rtp,srtp,udp", "rtp,sdp,mpegts"},
    {"udp", "udp", VICTORIOUS_STREAM_FORMATS},
    {"srt", "srt", VICTORIOUS_STREAM_FORMATS},
    {"tcp", "tcp", VICTORIOUS_STREAM_FORMATS},
    {"http,https,rtmp,rtmps,rtmpt,mmsh", "http,https,httpproxy,crypto,tcp,tls,rtmp,rtmps,rtmpt,mmsh",
     VICTORIOUS_STREAM_FORMATS ",hls"},
}};
#undef VICTORIOUS_STREAM_FORMATS

const RemoteAccess& AccessOf(std::string_view scheme) {
  const auto has_scheme = [&](const RemoteAccess& access) {
    return std::ranges::any_of(access.schemes | std::views::split(','),
                               [&](const auto& one) { return std::string_view(one.begin(), one.end()) == scheme; });
  };
  const auto found = std::ranges::find_if(kRemoteAccess, has_scheme);
  VICTORIOUS_CHECK(found != kRemoteAccess.end());  // Open() has checked it
  return *found;
}

class Dictionary {
 public:
  Dictionary() = default;
  ~Dictionary() { av_dict_free(&entries_); }
  Dictionary(const Dictionary&) = delete;
  Dictionary& operator=(const Dictionary&) = delete;

  void Set(const char* key, const char* value) { av_dict_set(&entries_, key, value, 0); }
  AVDictionary** address() { return &entries_; }

 private:
  AVDictionary* entries_ = nullptr;
};

bool IsCoverImage(const AVStream& stream) { return (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) != 0; }

// Sort key of video streams, greatest is best: decodable, flagged as default, most pixels, lowest index.
auto VideoRank(const AVStream& stream) {
  const AVCodecParameters& codec = *stream.codecpar;
  return std::tuple(avcodec_find_decoder(codec.codec_id) != nullptr, (stream.disposition & AV_DISPOSITION_DEFAULT) != 0,
                    std::int64_t{codec.width} * codec.height, -stream.index);
}

}  // namespace

const char* VideoFileFormats() { return kVideoFileFormats; }

std::optional<std::string> UrlScheme(const std::string& source) {
  const std::size_t end = source.find("://");
  if (end == std::string::npos || end == 0) return std::nullopt;
  const std::string scheme = source.substr(0, end);
  const auto belongs = [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.'; };
  if (!std::ranges::all_of(scheme, belongs)) return std::nullopt;
  return LowerCase(scheme);
}

Status CheckUrlScheme(const std::string& url) {
  const auto scheme = UrlScheme(url);
  if (scheme && std::ranges::find(kUrlSchemes, *scheme) != kUrlSchemes.end()) return {};
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not a kind of address that can be read; use one of {}", url,
                                                       fmt::join(kUrlSchemes, ", ")));
}

Expected<std::optional<bool>> IsLiveAddress(const std::string& source) {
  const auto scheme = UrlScheme(source);
  if (!scheme) return false;
  VICTORIOUS_RETURN_IF_ERROR(CheckUrlScheme(source));
  return *scheme == "http" || *scheme == "https" ? std::optional<bool>() : true;
}

Expected<std::unique_ptr<Demuxer>> Demuxer::Open(const MediaSource& source) {
  PrepareFfmpeg();
  if (source.remote) VICTORIOUS_RETURN_IF_ERROR(CheckUrlScheme(source.name));
  std::unique_ptr<Demuxer> demuxer(new Demuxer(source));
  VICTORIOUS_RETURN_IF_ERROR(demuxer->OpenContainer());
  VICTORIOUS_RETURN_IF_ERROR(demuxer->SelectVideoStream());
  return demuxer;
}

Demuxer::~Demuxer() {
  StartTimer();  // closing a live source may send a message to the peer
  avformat_close_input(&context_);
}

int Demuxer::Read(AVPacket* packet) {
  StartTimer();
  const int result = av_read_frame(context_, packet);
  return result < 0 && IsTimedOut() ? AVERROR_EXIT : result;  // not every protocol reports a timeout as such
}

int Demuxer::SeekBefore(std::int64_t stamp) {
  return av_seek_frame(context_, video_index_, stamp, AVSEEK_FLAG_BACKWARD);
}

bool Demuxer::IsLive() const {
  const auto scheme = UrlScheme(source_.name);
  if (!source_.remote) return false;
  if (scheme != "http" && scheme != "https") return true;
  // A playlist always has a size in bytes; only a complete one has a duration.
  const bool has_duration =
      context_->duration > 0 && context_->duration_estimation_method != AVFMT_DURATION_FROM_BITRATE;
  const bool playlist = std::string_view(context_->iformat->name) == "hls";
  return !has_duration && (playlist || size_bytes() == 0);
}

std::int64_t Demuxer::size_bytes() const {
  return context_->pb == nullptr ? 0 : std::max<std::int64_t>(0, avio_size(context_->pb));
}

Status Demuxer::OpenContainer() {
  context_ = avformat_alloc_context();
  if (context_ == nullptr) return Fail(ErrorCode::kInternal, "no memory for a container");
  context_->interrupt_callback = {[](void* self) { return static_cast<Demuxer*>(self)->IsTimedOut() ? 1 : 0; }, this};
  Dictionary options;
  if (source_.remote) {
    const RemoteAccess& access = AccessOf(UrlScheme(source_.name).value_or(""));
    options.Set("protocol_whitelist", access.protocols);
    options.Set("format_whitelist", access.formats);
  } else {
    options.Set("protocol_whitelist", "file");
    options.Set("format_whitelist", kFileFormats);
  }
  // By default 5 s of the stream are analysed, which delays a live source, and is longer than the time limit for one
  // that sends slowly.
  if (source_.remote) options.Set("analyzeduration", "2000000");
  options.Set("rtsp_flags", "prefer_tcp");
  options.Set("overrun_nonfatal", "1");
  const std::string url = source_.remote ? source_.name : "file:" + source_.name;
  if (source_.remote) VICTORIOUS_RETURN_IF_ERROR(CheckVerifies(UrlScheme(source_.name).value_or(""), source_.name));
  static_cast<void>(TakeTlsFault());  // of another connection
  StartTimer();
  int result = avformat_open_input(&context_, url.c_str(), nullptr, options.address());  // frees context_ on failure
  if (result < 0) return std::unexpected(OpenError(result));
  StartTimer();
  analysed_since_ = Clock::now();
  result = avformat_find_stream_info(context_, nullptr);
  if (result < 0) return std::unexpected(OpenError(result));
  if (IsTimedOut() && context_->pb != nullptr) {  // what came until then suffices; the source goes on
    context_->pb->error = 0;
    context_->pb->eof_reached = 0;
  }
  return {};
}

Status Demuxer::SelectVideoStream() {
  std::vector<const AVStream*> videos;
  bool cover = false;
  for (unsigned i = 0; i < context_->nb_streams; ++i) {
    const AVStream* stream = context_->streams[i];
    if (stream->codecpar->codec_type != AVMEDIA_TYPE_VIDEO) continue;
    cover = cover || IsCoverImage(*stream);
    if (!IsCoverImage(*stream)) videos.push_back(stream);
  }
  if (videos.empty()) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: no video stream{}", source_.name, cover ? ", only a cover image" : " in it"));
  }
  const auto rank = [](const AVStream* stream) { return VideoRank(*stream); };
  video_index_ = (*std::ranges::max_element(videos, {}, rank))->index;
  return {};
}

void Demuxer::StartTimer() {
  if (!source_.remote) return;
  deadline_ =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(source_.timeout_s));
}

Error Demuxer::OpenError(int result) const {
  if (source_.remote) {
    // Also of a source that is encrypted only in part, as a playlist.
    if (const std::string fault = TakeTlsFault(); !fault.empty() && !IsTimedOut()) {
      return {ErrorCode::kNotFound, fmt::format("{}: {}", source_.name, fault)};
    }
    const std::string reason =
        IsTimedOut() ? fmt::format("no answer within {:g} s", source_.timeout_s) : FfmpegErrorText(result);
    return {ErrorCode::kNotFound, fmt::format("{}: {}; check that the source is sending", source_.name, reason)};
  }
  if (result == AVERROR(EACCES) || result == AVERROR(ENOENT)) return ErrorFromErrno(AVUNERROR(result), source_.name);
  return {ErrorCode::kDataLoss, fmt::format("{}: not a video that can be read, or a damaged header", source_.name)};
}

bool Demuxer::IsTimedOut() const {
  return deadline_ && (Clock::now() > *deadline_ || (source_.cancel != nullptr && source_.cancel->IsCancelled()));
}

}  // namespace victorious
