// From bytes to decoded KLV packets: bare, or as a video's container hands them out.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "victorious/telemetry/klv.h"
#include "victorious/telemetry/klv_packet.h"
#include "victorious/types/data_packet.h"

namespace victorious {

struct KlvPackets {
  std::vector<KlvPacket> packets;
  std::vector<std::string> warnings;  ///< where bytes were passed over
};

[[nodiscard]] KlvPackets DecodeKlv(Bytes bytes);

/// Those of kind kKlv, with the container's stream and time; the others are passed over. A unit may come in pieces.
[[nodiscard]] KlvPackets DecodeKlv(std::span<const DataPacket> packets);

/// Microseconds since 1970-01-01 UTC by the packet's own clock; nothing if it does not say, or says 0.
[[nodiscard]] std::optional<std::int64_t> PrecisionTime(const KlvPacket& packet);

/// "MISB ST 0601", "MISB EG 0104", "other".
[[nodiscard]] std::string_view Name(KlvStandard standard);

}  // namespace victorious
