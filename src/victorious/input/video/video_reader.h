// Reads videos: the first stage of every pipeline. Input: a file, a folder of images or a live URL. Output: frames by
// presentation time, and the data packets (telemetry, subtitles) beside them. Decoding uses FFmpeg (libavformat,
// libavcodec, libswscale), whose types do not leave this folder.
//
//   time_s = (presentation time stamp - that of the first frame) * time base
//
// Times are strictly increasing; a frame's index counts the delivered frames. Grey is BT.601 luma, 0 black to 255
// white, and agrees with GreyFromBgr (image_file.h) of the colour frame within 3 levels, and 1.2 on average, for every
// stored range and matrix.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/base/file.h"
#include "victorious/types/data_packet.h"
#include "victorious/types/frame.h"

namespace victorious {

enum class FrameColor {
  kGrey,
  kBgr,
  kGreyAndBgr,  ///< grey in Frame::image, colour in Frame::bgr
};

struct VideoReaderOptions {
  FrameColor color = FrameColor::kGrey;  ///< kGrey for the feature extraction, kBgr for display, both for detectors
  bool data_packets = false;             ///< collect data packets for TakeDataPackets()
  int threads = 0;                       ///< decoder threads; 0: all cores
  double open_timeout_s = 10.0;          ///< live sources: maximum wait for the first packet, and between packets
  double folder_frame_rate = 10.0;       ///< frames/s of a folder of images, which has no time stamps
};

enum class StreamType { kVideo, kAudio, kData, kSubtitle, kOther };

inline constexpr auto kStreamTypeTexts = std::to_array<EnumText<StreamType>>({{StreamType::kVideo, "video"},
                                                                              {StreamType::kAudio, "audio"},
                                                                              {StreamType::kData, "data"},
                                                                              {StreamType::kSubtitle, "subtitle"},
                                                                              {StreamType::kOther, "other"}});

/// One stream of the container, as reported by `victorious doctor`.
struct StreamInfo {
  int index = 0;
  StreamType type = StreamType::kOther;
  std::string codec;  ///< FFmpeg's name: "h264", "klv", …; of unknown data its four letters: "gpmd"
};

struct VideoInfo {
  std::string container;                    ///< FFmpeg's name, "folder of images" or "image"
  std::string codec;                        ///< FFmpeg's name of the video codec
  int width = 0;                            ///< px, after rotation, with square pixels
  int height = 0;                           ///< px, after rotation, with square pixels
  int rotation_deg = 0;                     ///< applied clockwise rotation: 0, 90, 180, 270
  double pixel_aspect = 1;                  ///< sample aspect ratio as stored: pixel width over height
  double frame_rate = 0;                    ///< average, frames/s; 0 if unknown
  std::optional<double> duration_s;         ///< as given by the container
  bool is_duration_estimated = false;       ///< from the bitrate: the video may be longer or shorter
  std::optional<std::int64_t> frame_count;  ///< as given by the container, or an estimate; for progress display only
  bool live = false;                        ///< true for a URL of unknown length, which cannot be read twice
  /// Of a live source: when its first frames may have come, which wait while it is opened.
  std::optional<std::chrono::steady_clock::time_point> live_since;
  bool of_images = false;  ///< a folder of images or one image: they may be far apart in time
  std::vector<StreamInfo> streams;
};

/// Whether an address is that of a live source; std::nullopt: only opening it tells (http). False for a path. Error:
/// kInvalidArgument for an address of a kind that cannot be read.
[[nodiscard]] Expected<std::optional<bool>> IsLiveAddress(const std::string& source);

/// Reads one source from its beginning to its end. Not thread-safe; not copyable.
class VideoReader {
 public:
  /// Opens a source and decodes its first frame, so that info() describes the delivered frames. A local file cannot
  /// cause other files or URLs to be opened: playlists are refused.
  /// @param source  a path (file, folder or single image) or a URL ("rtsp://…", "udp://…", "http://…")
  /// Errors: kNotFound (also a URL without an answer), kInvalidArgument (empty, a folder without images), kDataLoss
  /// (not a video), kUnsupported (no decoder); each message is one line and names the remedy.
  [[nodiscard]] static Expected<std::unique_ptr<VideoReader>> Open(const std::string& source,
                                                                   const VideoReaderOptions& options);

  virtual ~VideoReader() = default;

  [[nodiscard]] virtual const VideoInfo& info() const = 0;

  /// Returns an identifier of the content, independent of the name: a hash of a file, or of the images of a folder (not
  /// of its other files); URL and length for a network source of known length; URL and current time for a live source,
  /// unique for each call. Reads a file once. Errors: those of ContentId (base/file.h), among them kCancelled.
  [[nodiscard]] virtual Expected<std::string> ContentId(const CancelToken& cancel,
                                                        const ByteProgress& progress) const = 0;

  /// Returns the next frame in presentation order; std::nullopt at the end. Damaged parts are skipped and reported by
  /// warnings(). The frame owns its pixels and may be passed to another thread.
  [[nodiscard]] virtual Expected<std::optional<Frame>> NextFrame() = 0;

  /// Returns the data packets read since the last call, in file order; empty unless options.data_packets.
  virtual std::vector<DataPacket> TakeDataPackets() = 0;

  /// Seeks, forwards or backwards, to a key frame at or shortly before `time_s`, without decoding the frames in
  /// between. Afterwards a frame is identified by its time: the index continues to count delivered frames. The first
  /// frames may be damaged, which warnings() reports.
  /// @return false if the source is not seekable or time_s is near the beginning: the caller must then reopen the
  ///               source
  virtual bool SeekTo(double time_s) = 0;

  /// Reads to the end without decoding: collects the data packets of a whole file quickly, and checks for a premature
  /// end (warnings()). NextFrame returns std::nullopt afterwards.
  virtual void SkipToEnd() = 0;

  /// UTC at which a frame of this time came to this machine, if it was not late, microseconds since 1970: the packet
  /// that waited least tells it (LiveDelay, frame_loop.h). std::nullopt for what is not live. From any thread.
  [[nodiscard]] virtual std::optional<std::int64_t> ArrivalUtc(double /*time_s*/) const { return std::nullopt; }

  /// Returns the damage found so far, one line per kind with time and count: "decoding stopped at 3.20 s of 10.00 s:
  /// …", and the notes. Repetitions rewrite the line of their kind, so read the lines at the end.
  [[nodiscard]] virtual const std::vector<std::string>& warnings() const = 0;

  /// Those of warnings() that are no damage: a stream that begins without a key frame, a stretched range of grey.
  [[nodiscard]] virtual const std::vector<std::string>& notes() const {
    static const std::vector<std::string> none;
    return none;
  }

  [[nodiscard]] bool has_damage() const { return warnings().size() > notes().size(); }
};

}  // namespace victorious
