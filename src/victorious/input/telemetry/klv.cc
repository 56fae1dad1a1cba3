#include "victorious/input/telemetry/klv.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr std::array kLabelStart = {std::byte{0x06}, std::byte{0x0E}, std::byte{0x2B}, std::byte{0x34}};

// The offset of the first label in `bytes`, or their size.
std::size_t FindLabel(Bytes bytes) {
  return static_cast<std::size_t>(std::ranges::search(bytes, kLabelStart).begin() - bytes.begin());
}

}  // namespace

std::optional<std::uint64_t> TakeBerLength(Bytes& bytes) {
  if (bytes.empty()) return std::nullopt;
  const auto first = std::to_integer<unsigned>(bytes[0]);
  bytes = bytes.subspan(1);
  if (first < 0x80) return first;
  const std::size_t count = first & 0x7F;
  if (count == 0 || count > bytes.size()) return std::nullopt;
  Bytes digits = bytes.first(count);
  bytes = bytes.subspan(count);
  while (digits.size() > sizeof(std::uint64_t)) {  // digits that exceed 64 bits must be zero
    if (digits[0] != std::byte{0}) return std::nullopt;
    digits = digits.subspan(1);
  }
  return ReadUnsigned(digits);
}

std::optional<std::uint64_t> TakeBerOid(Bytes& bytes) {
  constexpr std::uint64_t kFull = std::uint64_t{1} << 57;  // seven more bits would overflow
  std::uint64_t number = 0;
  while (!bytes.empty() && number < kFull) {
    const auto digit = std::to_integer<std::uint64_t>(bytes[0]);
    bytes = bytes.subspan(1);
    number = number << 7 | (digit & 0x7F);
    if (digit < 0x80) return number;
  }
  return std::nullopt;
}

std::uint64_t ReadUnsigned(Bytes bytes) {
  std::uint64_t number = 0;
  for (const std::byte digit : bytes) number = number << 8 | std::to_integer<std::uint64_t>(digit);
  return number;
}

std::int64_t ReadSigned(Bytes bytes) {
  const std::uint64_t number = ReadUnsigned(bytes);
  if (bytes.empty() || std::to_integer<unsigned>(bytes[0]) < 0x80 || bytes.size() >= sizeof(number)) {
    return static_cast<std::int64_t>(number);
  }
  return static_cast<std::int64_t>(number | ~std::uint64_t{0} << (8 * bytes.size()));
}

KlvUnits SplitKlv(Bytes bytes) {
  KlvUnits found;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t skipped = FindLabel(bytes.subspan(at));
    at += skipped;
    if (at == bytes.size()) break;
    const Bytes rest = bytes.subspan(at);
    Bytes value = rest.subspan(std::min(kUniversalLabelSize, rest.size()));
    const auto length = TakeBerLength(value);
    if (!length || *length > value.size()) {
      found.warnings.Add(length ? fmt::format("a KLV unit at byte {} is truncated: its length is {} bytes, {} are left",
                                              at, *length, value.size())
                                : fmt::format("a KLV unit at byte {} is truncated before its length", at));
      if (!found.cut_off) found.cut_off = at;
      at += kLabelStart.size();
      continue;
    }
    const auto head = static_cast<std::size_t>(value.data() - rest.data());
    const auto size = head + static_cast<std::size_t>(*length);
    found.units.push_back({.offset = at,
                           .whole = rest.first(size),
                           .label = rest.first(kUniversalLabelSize),
                           .value = value.first(static_cast<std::size_t>(*length))});
    at += size;
    found.cut_off.reset();
  }
  return found;
}

bool StartsWithUniversalLabel(Bytes bytes) {
  return bytes.size() >= kLabelStart.size() && std::ranges::equal(bytes.first(kLabelStart.size()), kLabelStart);
}

std::string HexText(Bytes bytes) {
  std::string text;
  for (const std::byte value : bytes) text += fmt::format("{:02x}", std::to_integer<unsigned>(value));
  return text;
}

}  // namespace victorious
