// Private to video/: buffers data packets until the time of the first frame, which is the origin of their times, is
// known.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "victorious/input/video/ffmpeg_handles.h"
#include "victorious/input/video/time_base_joints.h"
#include "victorious/types/data_packet.h"

namespace victorious {

/// Returns true for a stream of data packets: anything but video, audio and attachments.
[[nodiscard]] bool IsDataStream(const AVStream& stream);

class DataTrack {
 public:
  /// Buffers a packet of `stream`.
  /// @param joints  the number of joints that are known
  void Add(const AVStream& stream, const AVPacket& packet, std::size_t joints);

  /// Returns all packets since the last call, in the order of Add, with times relative to `origin_s`, moved as the
  /// frames are. Without an origin (the video has no time stamps) the packets have no time.
  std::vector<DataPacket> Take(std::optional<double> origin_s, const TimeBaseJoints& joints);

 private:
  DataKind DetectKind(const AVStream& stream, std::span<const std::byte> bytes);

  std::set<int> klv_streams_;  ///< streams that had KLV
  struct Origin {
    std::int64_t position = -1;  ///< in the file, bytes
    std::size_t joints = 0;      ///< known when it was read
  };
  std::vector<DataPacket> packets_;  ///< times in the container's clock
  std::vector<Origin> origins_;      ///< of packets_
};

}  // namespace victorious
