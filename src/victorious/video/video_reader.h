// video/, in: a file, a folder of images, or a live URL. Out: frames by presentation time, and the data packets beside
// them. Decoding is FFmpeg's (libavformat, libavcodec, libswscale), which stays inside this folder.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/data_packet.h"
#include "victorious/types/frame.h"

namespace victorious {

enum class FrameColor { kGrey, kBgr };

struct VideoReaderOptions {
  FrameColor color = FrameColor::kGrey;  ///< features need grey; people want colour
  bool data_packets = false;             ///< keep the data packets for TakeDataPackets()
  int threads = 0;                       ///< decoder threads; 0: as many as the machine has
  double open_timeout_s = 10.0;          ///< for live sources: until the first packet, and between packets
};

/// One stream of the container, as `doctor` tells it.
struct StreamInfo {
  int index = 0;
  std::string type;   ///< "video", "audio", "data", "subtitle", "other"
  std::string codec;  ///< FFmpeg's name: "h264", "klv", …
};

struct VideoInfo {
  std::string container;                    ///< FFmpeg's name, or "folder of images"
  std::string codec;                        ///< of the video stream
  int width = 0;                            ///< px, upright
  int height = 0;                           ///< px, upright
  int rotation_deg = 0;                     ///< clockwise turn that made it upright: 0, 90, 180, 270
  double frame_rate = 0;                    ///< average, frames/s; 0 if unknown
  std::optional<double> duration_s;         ///< as the container says
  std::optional<std::int64_t> frame_count;  ///< as the container says, or an estimate: for progress, nothing else
  bool live = false;                        ///< a URL that cannot be read twice
  std::vector<StreamInfo> streams;
};

/// Reads one source from its beginning to its end. Not thread-safe; not copyable.
class VideoReader {
 public:
  /// @param source  a path (file or folder) or a URL ("rtsp://…", "udp://…", "http://…")
  /// Errors: kNotFound, kInvalidArgument (empty, a folder without images), kDataLoss (not a video), kUnsupported (no
  /// decoder), each with one line that says what would be right.
  static Expected<std::unique_ptr<VideoReader>> Open(const std::string& source, const VideoReaderOptions& options);

  virtual ~VideoReader() = default;

  [[nodiscard]] virtual const VideoInfo& info() const = 0;

  /// The next frame in order of presentation; nothing at the end. Damaged parts are passed over and told by warnings();
  /// a source in which no frame at all can be decoded is an error (kDataLoss).
  virtual Expected<std::optional<Frame>> NextFrame() = 0;

  /// The data packets met since the last call, in the order of the file (options.data_packets).
  virtual std::vector<DataPacket> TakeDataPackets() = 0;

  /// What was damaged so far and where, one line each: "decoding stopped at 3.20 s of 10.00 s: …".
  [[nodiscard]] virtual const std::vector<std::string>& warnings() const = 0;
};

}  // namespace victorious
