// An undecoded packet of a data stream in the video container: telemetry or subtitles.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace victorious {

enum class DataKind {
  kKlv,       ///< SMPTE 336 KLV, synchronous (MPEG-TS stream type 0x15) or asynchronous (0x06)
  kSubtitle,  ///< text subtitles, as DJI aircraft write their telemetry
  kOther,     ///< anything else that is neither video nor audio
};

struct DataPacket {
  int stream = 0;  ///< the container's stream index
  DataKind kind = DataKind::kOther;
  std::optional<double> time_s;  ///< presentation time, seconds since the video's first frame; nullopt if unstamped
  std::vector<std::byte> bytes;  ///< the payload as stored
};

}  // namespace victorious
