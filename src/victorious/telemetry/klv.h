// SMPTE ST 336 as MISB uses it: a 16-byte universal label, a length by ASN.1's basic encoding rules (BER), a value.
//
// Bytes that begin no unit are passed over up to the next label, so that what a damaged stream still holds is found,
// and headers of MPEG-TS metadata cells between units do no harm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace victorious {

using Bytes = std::span<const std::byte>;

inline constexpr std::size_t kUniversalLabelSize = 16;

/// Takes a BER length, short or long, off the front of `bytes`. Nothing where it is cut off, indefinite or beyond what
/// 64 bits hold; `bytes` is then anywhere.
[[nodiscard]] std::optional<std::uint64_t> TakeBerLength(Bytes& bytes);

/// Takes a BER object identifier (seven bits a byte, the last without the top bit) off the front of `bytes`.
[[nodiscard]] std::optional<std::uint64_t> TakeBerOid(Bytes& bytes);

/// Big-endian, of at most eight bytes.
[[nodiscard]] std::uint64_t UnsignedOf(Bytes bytes);
[[nodiscard]] std::int64_t SignedOf(Bytes bytes);

/// A unit, whole: label, length, value. Points into the bytes that were split.
struct KlvUnit {
  std::size_t offset = 0;  ///< of its label, bytes from the front
  Bytes whole;             ///< label, length and value
  Bytes label;
  Bytes value;
};

struct KlvUnits {
  std::vector<KlvUnit> units;
  std::vector<std::string> warnings;   ///< a line for each place where bytes were passed over or cut off
  std::optional<std::size_t> cut_off;  ///< where a unit begins that goes on beyond the bytes, behind all others
};

[[nodiscard]] KlvUnits SplitKlv(Bytes bytes);

/// Whether a universal label stands at the front.
[[nodiscard]] bool StartsWithUniversalLabel(Bytes bytes);

/// Two digits a byte.
[[nodiscard]] std::string HexText(Bytes bytes);

}  // namespace victorious
