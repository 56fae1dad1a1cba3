// Private to video/: opens a container, selects its video stream and reads packets. Every blocking call on a remote
// source has a timeout, and only the given source is opened (no files or URLs that it refers to).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/input/video/ffmpeg_handles.h"

namespace victorious {

/// The source as given by the user.
struct MediaSource {
  std::string name;                     ///< path or URL
  bool remote = false;                  ///< true for a URL
  double timeout_s = 10;                ///< limit of each open and read call; remote sources only
  const CancelToken* cancel = nullptr;  ///< ends each open and read call as the limit does; remote sources only
};

/// Returns the scheme of a URL such as "rtsp://…", in lower case; std::nullopt if `source` is a path.
[[nodiscard]] std::optional<std::string> UrlScheme(const std::string& source);

/// Error: kInvalidArgument for a URL of a kind that cannot be read, or a path.
[[nodiscard]] Status CheckUrlScheme(const std::string& url);

/// The names of the formats of local files that may hold a picture, separated by commas, as FFmpeg names them.
[[nodiscard]] const char* VideoFileFormats();

class Demuxer {
 public:
  /// Opens a source. Errors: kInvalidArgument (unsupported URL scheme), kNotFound (also a URL without an answer),
  /// kPermissionDenied, kDataLoss (not a video, or without a video stream).
  [[nodiscard]] static Expected<std::unique_ptr<Demuxer>> Open(const MediaSource& source);
  ~Demuxer();
  Demuxer(const Demuxer&) = delete;
  Demuxer& operator=(const Demuxer&) = delete;

  /// Reads the next packet of any stream that is not discarded. Returns FFmpeg's result: AVERROR_EOF at the end,
  /// AVERROR_EXIT on timeout.
  int Read(AVPacket* packet);

  /// Seeks to the last key frame of the video at or before `stamp` (units of the stream's time base). Returns FFmpeg's
  /// result.
  int SeekBefore(std::int64_t stamp);

  /// Returns true for a remote source of unknown length, which cannot be read a second time.
  [[nodiscard]] bool IsLive() const;

  /// When the first packets may have come, which are analysed before the source is open.
  [[nodiscard]] std::chrono::steady_clock::time_point analysed_since() const { return analysed_since_; }

  /// Size of the source in bytes as reported by the protocol; 0 if unknown.
  [[nodiscard]] std::int64_t size_bytes() const;

  [[nodiscard]] const AVFormatContext& container() const { return *context_; }
  [[nodiscard]] AVStream& stream(int index) const { return *context_->streams[index]; }
  [[nodiscard]] AVStream& video() const { return *context_->streams[video_index_]; }

  /// Discards the packets of streams for which `wanted` is false; they are not parsed if the format allows it.
  template <typename Predicate>
  void KeepStreams(Predicate wanted) {
    for (unsigned i = 0; i < context_->nb_streams; ++i) {
      AVStream& stream = *context_->streams[i];
      stream.discard = wanted(stream) ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  explicit Demuxer(const MediaSource& source) : source_(source) {}
  [[nodiscard]] Status OpenContainer();
  [[nodiscard]] Status SelectVideoStream();
  void StartTimer();
  [[nodiscard]] Error OpenError(int result) const;
  [[nodiscard]] bool IsTimedOut() const;

  MediaSource source_;
  AVFormatContext* context_ = nullptr;
  std::optional<Clock::time_point> deadline_;
  Clock::time_point analysed_since_;
  int video_index_ = -1;
};

}  // namespace victorious
