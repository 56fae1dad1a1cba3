// telemetry/: MISB ST 0601 (UAS Datalink Local Set): items of BER-OID number, BER length and value, under one label.
//
// The standard's linear maps apply to the length that the packet gives. With n bits, unsigned:
//   x = min + (max - min) y / (2^n - 1),  signed:  x = max y / (2^(n-1) - 1),
// and the lowest signed number means "no value". IMAPB is defined by ST 1201. Nested sets are not decoded: their items
// are counted, and their bytes are kept. Nothing below the first level is opened.
#pragma once

#include <optional>

#include "victorious/input/telemetry/klv.h"
#include "victorious/input/telemetry/klv_packet.h"

namespace victorious {

/// Whether the label is that of the local set, in any version.
[[nodiscard]] bool IsSt0601Label(Bytes label);

/// Decodes the items and the checksum. Never fails: decodes as far as possible and describes the rest in `problem`.
[[nodiscard]] KlvPacket DecodeSt0601(const KlvUnit& unit);

/// The sum of the bytes as big-endian 16-bit words, modulo 2^16.
/// @param bytes  a packet, from its label up to the value of its checksum item, exclusive
[[nodiscard]] std::uint16_t St0601Checksum(Bytes bytes);

/// The reverse mapping B of ST 1201 of `bytes` (1 to 8) to [min, max]; std::nullopt for its special values, such as
/// NaN.
[[nodiscard]] std::optional<double> ImapbValue(Bytes bytes, double min, double max);

}  // namespace victorious
