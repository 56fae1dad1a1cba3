// telemetry/: decodes KLV packets from bare bytes or from the data packets of a video's container.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "victorious/base/warning_list.h"
#include "victorious/input/telemetry/klv.h"
#include "victorious/input/telemetry/klv_packet.h"
#include "victorious/types/data_packet.h"

namespace victorious {

struct KlvPackets {
  std::vector<KlvPacket> packets;
  WarningList warnings;  ///< one per truncated unit
};

/// Decodes all units in the bytes. Units of unknown standards have no items.
[[nodiscard]] KlvPackets DecodeKlv(Bytes bytes);

/// Decodes the data packets of kind kKlv, with the container's stream and time; ignores the others. Reassembles a unit
/// that spans several data packets of its stream; it has the time of the first.
[[nodiscard]] KlvPackets DecodeKlv(std::span<const DataPacket> packets);

/// The packet's own time stamp, microseconds since 1970-01-01; std::nullopt if absent, 0 or beyond the year 9999. Most
/// producers count UTC, those that follow ST 0603 count without leap seconds.
[[nodiscard]] std::optional<std::int64_t> PrecisionTime(const KlvPacket& packet);

/// The same in UTC: with the leap seconds of item 136, where the stream has it.
[[nodiscard]] std::optional<std::int64_t> UtcTime(const KlvPacket& packet);

/// Item 136 of the packet, the leap seconds to be added to its time stamp; std::nullopt if absent or impossible.
[[nodiscard]] std::optional<std::int64_t> LeapSeconds(const KlvPacket& packet);

}  // namespace victorious
