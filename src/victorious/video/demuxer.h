// Private to video/: opens a container, chooses its video stream and hands out packets, without ever waiting for longer
// than the timeout and without opening anything but the one source.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "victorious/base/error.h"
#include "victorious/video/ffmpeg_handles.h"

namespace victorious {

/// A file's path or a URL, as the user wrote it.
struct MediaSource {
  std::string name;
  bool remote = false;    ///< a URL
  double timeout_s = 10;  ///< of a remote source
};

/// The scheme of "rtsp://…", in lower case; nothing if `source` is a path.
[[nodiscard]] std::optional<std::string> UrlScheme(const std::string& source);

class Demuxer {
 public:
  static Expected<std::unique_ptr<Demuxer>> Open(const MediaSource& source);
  ~Demuxer();
  Demuxer(const Demuxer&) = delete;
  Demuxer& operator=(const Demuxer&) = delete;

  /// The next packet of any stream that is not discarded. Returns FFmpeg's result: AVERROR_EOF at the end.
  int Read(AVPacket* packet);

  /// Goes on with packets from a key frame of the video at or before a stamp, in units of the stream's time base.
  /// Returns FFmpeg's result.
  int SeekBefore(std::int64_t stamp);

  /// A remote source that sends what is there now, and no more of it later: any that does not tell its length.
  [[nodiscard]] bool IsLive() const;

  /// As the protocol tells it; 0 if it does not.
  [[nodiscard]] std::int64_t size_bytes() const;

  [[nodiscard]] const AVFormatContext& container() const { return *context_; }
  [[nodiscard]] AVStream& stream(int index) const { return *context_->streams[index]; }
  [[nodiscard]] AVStream& video() const { return *context_->streams[video_index_]; }

  /// Packets of streams for which `wanted` is false will not be handed out, nor even parsed where that can be avoided.
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
  Status OpenContainer();
  Status ChooseVideo();
  void StartTimer();
  [[nodiscard]] Error OpenError(int result) const;
  [[nodiscard]] bool TimeIsUp() const;

  MediaSource source_;
  AVFormatContext* context_ = nullptr;
  std::optional<Clock::time_point> deadline_;
  int video_index_ = -1;
};

}  // namespace victorious
