// video/, in: a file, a folder of images, or a live URL. Out: frames by presentation time, and the data packets beside
// them. Decoding is FFmpeg's (libavformat, libavcodec, libswscale), which stays inside this folder.
//
//   time_s = (presentation time stamp - the first frame's) * time base
//
// strictly increasing; an index only counts what was delivered. Grey is BT.601 luma, 0 black to 255 white, the same as
// GreyFromBgr (image_file.h) of the colour frame, within 3 levels and 1.2 on average, in whatever range or matrix the
// video is stored.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/file.h"
#include "victorious/types/data_packet.h"
#include "victorious/types/frame.h"

namespace victorious {

enum class FrameColor { kGrey, kBgr };

struct VideoReaderOptions {
  FrameColor color = FrameColor::kGrey;  ///< features need grey; people want colour
  bool data_packets = false;             ///< keep the data packets for TakeDataPackets()
  int threads = 0;                       ///< decoder threads; 0: as many as the machine has
  double open_timeout_s = 10.0;          ///< for live sources: until the first packet, and between packets
  double folder_frame_rate = 10.0;       ///< frames/s of a folder of images, which carries no times
};

/// One stream of the container, as `doctor` tells it.
struct StreamInfo {
  int index = 0;
  std::string type;   ///< "video", "audio", "data", "subtitle", "other"
  std::string codec;  ///< FFmpeg's name: "h264", "klv", …
};

struct VideoInfo {
  std::string container;                    ///< FFmpeg's name, "folder of images" or "picture"
  std::string codec;                        ///< of the video stream
  int width = 0;                            ///< px, upright and square
  int height = 0;                           ///< px, upright and square
  int rotation_deg = 0;                     ///< clockwise turn that made it upright: 0, 90, 180, 270
  double pixel_aspect = 1;                  ///< width over height of a pixel as stored, before it was made square
  double frame_rate = 0;                    ///< average, frames/s; 0 if unknown
  std::optional<double> duration_s;         ///< as the container says
  std::optional<std::int64_t> frame_count;  ///< as the container says, or an estimate: for progress, nothing else
  bool live = false;                        ///< a URL that cannot be read twice: without an end that is known
  std::vector<StreamInfo> streams;
};

/// Reads one source from its beginning to its end. Not thread-safe; not copyable.
class VideoReader {
 public:
  /// Decodes as far as the first frame, so that info() is what will be delivered. A local file never makes other files
  /// or addresses be opened: playlists are refused.
  /// @param source  a path (file, folder or single picture) or a URL ("rtsp://…", "udp://…", "http://…")
  /// Errors: kNotFound (also a URL without an answer), kInvalidArgument (empty, a folder without images), kDataLoss
  /// (not a video), kUnsupported (no decoder), each with one line that says what would be right.
  static Expected<std::unique_ptr<VideoReader>> Open(const std::string& source, const VideoReaderOptions& options);

  virtual ~VideoReader() = default;

  [[nodiscard]] virtual const VideoInfo& info() const = 0;

  /// What the source is known by, whatever its name: the content of a file, of a folder's pictures (and of no other
  /// file in it); address and length of what can be read again over a network; of a live source address and moment,
  /// never twice the same. Reads a file once. Errors: those of ContentId (base/file.h), among them kCancelled.
  [[nodiscard]] virtual Expected<std::string> ContentId(const CancelToken& cancel,
                                                        const ByteProgress& progress) const = 0;

  /// The next frame in order of presentation; nothing at the end. Damaged parts are passed over and told by warnings().
  /// The frame owns its pixels: it may go to another thread.
  virtual Expected<std::optional<Frame>> NextFrame() = 0;

  /// The data packets met since the last call, in the order of the file (options.data_packets).
  virtual std::vector<DataPacket> TakeDataPackets() = 0;

  /// Goes on at, or somewhat before, a time of the video, forward or back, without decoding all up to there. Frames are
  /// known by their time from then on: their index counts on, and the first may be damaged, which warnings() tells.
  /// @return false where the source cannot, or at its beginning; it is to be opened anew then
  virtual bool SkipTo(double time_s) = 0;

  /// Reads on to the end without decoding: for the data packets of a whole file in little time, and for whether it ends
  /// where it should (warnings()). No frame comes after it.
  virtual void PassOverFrames() = 0;

  /// What was damaged so far and where, a line each: "decoding stopped at 3.20 s of 10.00 s: …". A kind of damage has
  /// one line, which is rewritten as it happens again: read them at the end.
  [[nodiscard]] virtual const std::vector<std::string>& warnings() const = 0;
};

}  // namespace victorious
