// MISB ST 0601 (UAS Datalink Local Set): numbered items of BER-OID number, BER length and value, under one label.
//
// The linear maps of the standard take the length that the packet gives: with n bits, unsigned
//   x = min + (max - min) y / (2^n - 1),  signed  x = max y / (2^(n-1) - 1),
// whose lowest number means "no value". IMAPB is ST 1201's. Sets within the set are measured item by
// item, and stay undecoded: whatever they hold, nothing is opened below the first level.
#pragma once

#include <optional>

#include "victorious/telemetry/klv.h"
#include "victorious/telemetry/klv_packet.h"

namespace victorious {

/// Whether it is the local set's label, of whichever version.
[[nodiscard]] bool IsSt0601Label(Bytes label);

/// Items, checksum and the place where a damaged packet stopped. Never fails: what can be read is read.
[[nodiscard]] KlvPacket DecodeSt0601(const KlvUnit& unit);

/// The sum of a packet's bytes up to its checksum's value, as 16-bit words, modulo 2^16.
[[nodiscard]] std::uint16_t St0601Checksum(Bytes bytes);

/// ST 1201's reverse mapping B of `bytes` (1 to 8) in [min, max]; nothing for its special values, among them NaN.
[[nodiscard]] std::optional<double> ImapbValue(Bytes bytes, double min, double max);

}  // namespace victorious
