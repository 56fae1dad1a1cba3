// telemetry/: KLV framing by SMPTE ST 336 as MISB uses it: a 16-byte universal label, a length by the basic encoding
// rules of ASN.1 (BER), a value.
//
// Bytes that do not start a unit are skipped up to the next label. This resynchronises on damaged streams, and skips
// the headers of MPEG-TS metadata cells between units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/warning_list.h"

namespace victorious {

using Bytes = std::span<const std::byte>;

inline Bytes AsBytes(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

inline constexpr std::size_t kUniversalLabelSize = 16;

/// Reads a BER length, short or long form, and removes it from the front of `bytes`.
/// @return std::nullopt if it is truncated, indefinite or exceeds 64 bits; `bytes` is then unspecified
[[nodiscard]] std::optional<std::uint64_t> TakeBerLength(Bytes& bytes);

/// Reads a BER object identifier (seven bits per byte; the last byte has its top bit clear) and removes it from the
/// front of `bytes`.
/// @return std::nullopt if it is truncated or exceeds 64 bits; `bytes` is then unspecified
[[nodiscard]] std::optional<std::uint64_t> TakeBerOid(Bytes& bytes);

/// Big-endian integers of at most eight bytes; the signed one in two's complement.
[[nodiscard]] std::uint64_t ReadUnsigned(Bytes bytes);
[[nodiscard]] std::int64_t ReadSigned(Bytes bytes);

/// A complete KLV unit. Its spans point into the bytes that SplitKlv was given.
struct KlvUnit {
  std::size_t offset = 0;  ///< of its label from the front, bytes
  Bytes whole;             ///< label, length and value
  Bytes label;
  Bytes value;
};

struct KlvUnits {
  std::vector<KlvUnit> units;
  WarningList warnings;                ///< one per truncated unit
  std::optional<std::size_t> cut_off;  ///< offset of a last unit that continues beyond the bytes
};

/// Splits bytes into KLV units.
[[nodiscard]] KlvUnits SplitKlv(Bytes bytes);

/// Whether the bytes start with a universal label.
[[nodiscard]] bool StartsWithUniversalLabel(Bytes bytes);

/// Lower-case hexadecimal, two digits per byte.
[[nodiscard]] std::string HexText(Bytes bytes);

}  // namespace victorious
