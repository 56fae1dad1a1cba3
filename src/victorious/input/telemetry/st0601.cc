#include "victorious/input/telemetry/st0601.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "victorious/input/telemetry/st0601_items.h"

namespace victorious {
namespace {

constexpr int kChecksumItem = 1;
constexpr std::size_t kMaxItems = 4096;  // per packet; a few hundred are usual, but zero bytes would decode as millions
constexpr std::size_t kMaxNumberSize = 8;

// A value, or the reason why there is none.
struct Decoded {
  KlvValue value;
  std::string note = {};
};

constexpr const char* kNoValue = "no value: out of range, or unknown to the producer";
constexpr const char* kBadLength = "not a valid length for this item";

// Some producers pad a number of the standard length with leading zeros; the map of the standard length then applies.
Bytes WithoutPadding(const ItemSpec& spec, Bytes bytes) {
  while (bytes.size() > spec.bytes && bytes[0] == std::byte{0}) bytes = bytes.subspan(1);
  return bytes;
}

Decoded DecodeLinear(const ItemSpec& spec, Bytes bytes) {
  if (spec.coding == ItemCoding::kLinearUnsigned) bytes = WithoutPadding(spec, bytes);
  const int bits = static_cast<int>(8 * bytes.size());
  if (spec.coding == ItemCoding::kLinearUnsigned) {
    const double largest = std::ldexp(1.0, bits) - 1;
    return {spec.min + (spec.max - spec.min) * (static_cast<double>(ReadUnsigned(bytes)) / largest)};
  }
  const double largest = std::ldexp(1.0, bits - 1) - 1;
  const auto number = static_cast<double>(ReadSigned(bytes));
  if (number < -largest) return {{}, kNoValue};
  return {spec.max * (number / largest)};
}

Decoded DecodeNumber(const ItemSpec& spec, Bytes bytes) {
  if (bytes.size() > kMaxNumberSize) return {{}, kBadLength};
  if (spec.coding == ItemCoding::kUnsigned) return {ReadUnsigned(bytes)};
  if (spec.coding == ItemCoding::kSigned) return {ReadSigned(bytes)};
  if (spec.coding != ItemCoding::kImapb) return DecodeLinear(spec, bytes);
  const auto value = ImapbValue(bytes, spec.min, spec.max);
  return value ? Decoded{*value} : Decoded{{}, kNoValue};
}

Decoded DecodeBerOids(Bytes bytes) {
  KlvList list;
  while (!bytes.empty()) {
    const auto number = TakeBerOid(bytes);
    if (!number) return {{}, "a truncated list"};
    list.push_back(*number);
  }
  return {list};
}

Decoded DecodeBytes(Bytes bytes) {
  KlvList list;
  for (const std::byte value : bytes) list.push_back(std::to_integer<std::uint64_t>(value));
  return {list};
}

Decoded DecodeBits(Bytes bytes) {
  KlvList list;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const auto value = std::to_integer<unsigned>(bytes[bytes.size() - 1 - bit / 8]);
    if ((value >> (bit % 8) & 1) != 0) list.push_back(bit);
  }
  return {list};
}

// An item's number and value, removed from the front of `bytes` by TakeItem; std::nullopt if truncated.
struct Item {
  std::uint64_t number = 0;
  Bytes value;
};

std::optional<Item> TakeItem(Bytes& bytes) {
  const auto number = TakeBerOid(bytes);
  const auto length = number ? TakeBerLength(bytes) : std::nullopt;
  if (!length || *length > bytes.size()) return std::nullopt;
  const Bytes value = bytes.first(static_cast<std::size_t>(*length));
  bytes = bytes.subspan(value.size());
  return Item{*number, value};
}

// Counts the items of a nested set without decoding them, at any depth.
Decoded DescribeSet(Bytes bytes) {
  Decoded decoded{KlvRaw(bytes.begin(), bytes.end())};
  std::size_t items = 0;
  for (Bytes rest = bytes; !rest.empty(); ++items) {
    const std::size_t at = bytes.size() - rest.size();
    if (TakeItem(rest)) continue;
    decoded.note =
        fmt::format("a set of {} items, then truncated at byte {} of {}; not decoded", items, at, bytes.size());
    return decoded;
  }
  decoded.note = fmt::format("a set of {} items; not decoded", items);
  return decoded;
}

Decoded DecodeValue(const ItemSpec& spec, Bytes bytes) {
  if (bytes.empty()) return {{}, "empty: the item no longer has a value"};
  switch (spec.coding) {
    case ItemCoding::kText:
      return {std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())};
    case ItemCoding::kBytes:
      return DecodeBytes(bytes);
    case ItemCoding::kBerOids:
      return DecodeBerOids(bytes);
    case ItemCoding::kBits:
      return DecodeBits(bytes);
    case ItemCoding::kSet:
      return DescribeSet(bytes);
    case ItemCoding::kRaw:
      return {KlvRaw(bytes.begin(), bytes.end())};
    default:
      return DecodeNumber(spec, bytes);
  }
}

KlvItem DecodeItem(std::uint64_t number, Bytes bytes) {
  const ItemSpec* spec = number <= 0xFFFF ? FindSt0601Item(static_cast<int>(number)) : nullptr;
  if (spec == nullptr) {
    const int shown = static_cast<int>(std::min<std::uint64_t>(number, 0x7FFFFFFF));
    return {.number = shown,
            .label = {},
            .name = "unknown",
            .unit = {},
            .value = KlvRaw(bytes.begin(), bytes.end()),
            .note = {}};
  }
  Decoded decoded = DecodeValue(*spec, bytes);
  return {.number = spec->number,
          .label = {},
          .name = spec->name,
          .unit = spec->unit,
          .value = std::move(decoded.value),
          .note = std::move(decoded.note),
          .is_set = spec->coding == ItemCoding::kSet};
}

}  // namespace

bool IsSt0601Label(Bytes label) {
  constexpr std::array<unsigned char, kUniversalLabelSize> kLabel = {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01,
                                                                     0x0E, 0x01, 0x03, 0x01, 0x01, 0x00, 0x00, 0x00};
  constexpr std::size_t kVersionByte = 7;
  if (label.size() != kLabel.size()) return false;
  for (std::size_t i = 0; i < kLabel.size(); ++i) {
    if (i != kVersionByte && std::to_integer<unsigned char>(label[i]) != kLabel[i]) return false;
  }
  return true;
}

std::uint16_t St0601Checksum(Bytes bytes) {
  unsigned sum = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    sum += std::to_integer<unsigned>(bytes[i]) << (i % 2 == 0 ? 8 : 0);
  }
  return static_cast<std::uint16_t>(sum);
}

std::optional<double> ImapbValue(Bytes bytes, double min, double max) {
  const int bits = static_cast<int>(8 * bytes.size());
  const std::uint64_t number = ReadUnsigned(bytes);
  const std::uint64_t top = std::uint64_t{1} << (bits - 1);
  if (number > top) return std::nullopt;  // special values (infinities, NaNs and others) exceed the top bit
  const int range_power = static_cast<int>(std::ceil(std::log2(max - min)));
  const double scale = std::ldexp(1.0, range_power - (bits - 1));
  const double shifted = min / scale;  // makes zero map to itself exactly
  const double offset = min < 0 && max > 0 ? shifted - std::floor(shifted) : 0;
  return scale * (static_cast<double>(number) - offset) + min;
}

KlvPacket DecodeSt0601(const KlvUnit& unit) {
  KlvPacket packet{.standard = KlvStandard::kSt0601, .label = HexText(unit.label), .offset = unit.offset};
  Bytes rest = unit.value;
  while (!rest.empty()) {
    const auto at = static_cast<std::size_t>(rest.data() - unit.value.data());
    if (packet.items.size() == kMaxItems) {
      packet.problem = fmt::format("more than {} items: the others, from byte {} of {} on, are not decoded", kMaxItems,
                                   at, unit.value.size());
      break;
    }
    const auto item = TakeItem(rest);
    if (!item) {
      packet.problem = fmt::format("truncated at byte {} of {}: no item can be read there", at, unit.value.size());
      break;
    }
    packet.items.push_back(DecodeItem(item->number, item->value));
    if (item->number == kChecksumItem && item->value.size() == sizeof(std::uint16_t)) {
      const Bytes summed = unit.whole.first(static_cast<std::size_t>(item->value.data() - unit.whole.data()));
      packet.checksum = {static_cast<std::uint16_t>(ReadUnsigned(item->value)), St0601Checksum(summed)};
    }
  }
  return packet;
}

}  // namespace victorious
