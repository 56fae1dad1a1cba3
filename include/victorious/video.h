// Frames of a video by presentation time.
//
//   Video video("flight.mp4");
//   while (std::optional<Frame> frame = video.Next()) Use(frame->image(), frame->time_s());
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <victorious/export.h>
#include <victorious/image.h>

namespace libvictorious {

/// A decoded image with its time. Never changes; copies share the pixels. Thread-safe.
class LIBVICTORIOUS_EXPORT Frame {
 public:
  [[nodiscard]] std::int64_t index() const noexcept;  ///< from 0, in order of presentation
  [[nodiscard]] double time_s() const noexcept;       ///< presentation time, s since the first frame of the video
  /// Upright, square pixels. Valid as long as this frame or a copy of it.
  [[nodiscard]] ImageView image() const noexcept;

  struct Impl;
  explicit Frame(std::shared_ptr<const Impl> impl);  ///< of the library
  Frame(const Frame& other);
  Frame(Frame&& other) noexcept;
  Frame& operator=(const Frame& other);
  Frame& operator=(Frame&& other) noexcept;
  ~Frame();

 private:
  std::shared_ptr<const Impl> impl_;
};

struct VideoSettings {
  PixelFormat format = PixelFormat::kBgr;  ///< of the frames: kGrey or kBgr
  int threads = 0;                         ///< that decode; 0: one a processor
  double folder_frame_rate = 10;           ///< frames/s of a folder of images, which has no times
};

struct VideoInfo {
  int width = 0;                            ///< px, of the frames as delivered
  int height = 0;                           ///< px
  double frame_rate = 0;                    ///< average, frames/s; 0: not known
  std::optional<double> duration_s;         ///< as the container says
  std::optional<std::int64_t> frame_count;  ///< as the container says, or an estimate
  bool live = false;                        ///< a source without an end, which cannot be read twice
  std::string codec;                        ///< FFmpeg's name: "h264"
};

/// Reads one source from its beginning to its end. Used by one thread at a time; can be moved, not copied.
class LIBVICTORIOUS_EXPORT Video {
 public:
  /// Opens a file, a folder of images, an image or a URL ("rtsp://…", "udp://…"). It is decoded in the calling process,
  /// as `victorious index` does: open files of strangers in a process that may be lost.
  /// Errors: kNotFound, kInvalidArgument, kDataLoss (not a video), kUnsupported (no decoder).
  explicit Video(const std::string& source, const VideoSettings& settings = {});
  Video(Video&& other) noexcept;
  Video& operator=(Video&& other) noexcept;
  ~Video();

  [[nodiscard]] VideoInfo info() const;

  /// The next frame in order of presentation; std::nullopt at the end. Damaged parts are skipped (warnings()).
  [[nodiscard]] std::optional<Frame> Next();

  /// Goes to a key frame at or shortly before a time. Afterwards a frame is identified by its time; its index goes on
  /// to count delivered frames. Returns false if the source cannot do so: nothing is changed.
  bool SeekTo(double time_s);

  /// The damage found so far, one line a kind.
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace libvictorious
