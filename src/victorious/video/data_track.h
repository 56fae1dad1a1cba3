// Private to video/: keeps the data packets until the first frame's time, which is their zero, is known.
#pragma once

#include <optional>
#include <vector>

#include "victorious/types/data_packet.h"
#include "victorious/video/ffmpeg_handles.h"

namespace victorious {

/// Whether a stream holds what DataPacket is for: neither picture nor sound.
[[nodiscard]] bool IsDataStream(const AVStream& stream);

class DataTrack {
 public:
  void Add(const AVStream& stream, const AVPacket& packet);

  /// All packets since the last call, their times counted from `origin_s`; none where the video has no clock.
  std::vector<DataPacket> Take(std::optional<double> origin_s);

 private:
  std::vector<DataPacket> packets_;  ///< times on the container's clock
};

}  // namespace victorious
