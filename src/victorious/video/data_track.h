// Private to video/: buffers data packets until the time of the first frame, which is the origin of their times, is
// known.
#pragma once

#include <optional>
#include <vector>

#include "victorious/types/data_packet.h"
#include "victorious/video/ffmpeg_handles.h"

namespace victorious {

/// Returns true for a stream of data packets: anything but video, audio and attachments.
[[nodiscard]] bool IsDataStream(const AVStream& stream);

class DataTrack {
 public:
  /// Buffers a packet of `stream`.
  void Add(const AVStream& stream, const AVPacket& packet);

  /// Returns all packets since the last call, in the order of Add, with times relative to `origin_s`. Without an origin
  /// (the video has no time stamps) the packets have no time.
  std::vector<DataPacket> Take(std::optional<double> origin_s);

 private:
  std::vector<DataPacket> packets_;  ///< times in the container's clock
};

}  // namespace victorious
