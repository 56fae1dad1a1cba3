// telemetry/: a decoded KLV unit: its items by number and name of their standard, with their values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "victorious/base/enum_text.h"

namespace victorious {

/// A list of integers; and the undecoded bytes of a nested set or of a pack.
using KlvList = std::vector<std::uint64_t>;
using KlvRaw = std::vector<std::byte>;

/// std::monostate if the item is marked "no value" or cannot be decoded.
using KlvValue = std::variant<std::monostate, std::int64_t, std::uint64_t, double, std::string, KlvList, KlvRaw>;

struct KlvItem {
  int number = 0;         ///< in ST 0601; 0 in a universal set
  std::string label;      ///< in a universal set: the item's label, hexadecimal
  std::string_view name;  ///< from the standard; "unknown" for numbers and labels that it lacks
  std::string_view unit;  ///< empty for counts and texts
  KlvValue value;
  std::string note;     ///< why there is no value, or the item count of a nested set; else empty
  bool is_set = false;  ///< a nested set: its value is KlvRaw

  /// The value as a number; std::nullopt if there is none or it is not a number.
  [[nodiscard]] std::optional<double> Number() const {
    if (const auto* real = std::get_if<double>(&value)) return *real;
    if (const auto* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
    return std::nullopt;
  }
};

enum class KlvStandard { kSt0601, kEg0104, kOther };

inline constexpr auto kKlvStandardTexts = std::to_array<EnumText<KlvStandard>>(
    {{KlvStandard::kSt0601, "MISB ST 0601"}, {KlvStandard::kEg0104, "MISB EG 0104"}, {KlvStandard::kOther, "other"}});

struct KlvChecksum {
  std::uint16_t expected = 0;  ///< as recorded in the packet
  std::uint16_t computed = 0;

  [[nodiscard]] bool IsValid() const { return expected == computed; }
};

struct KlvPacket {
  KlvStandard standard = KlvStandard::kOther;
  std::string label;             ///< of the unit, hexadecimal
  int stream = 0;                ///< the container's stream index; 0 for bare KLV
  std::size_t offset = 0;        ///< in the file for bare KLV, else in the container's packet, bytes
  std::optional<double> time_s;  ///< from the container, on the video's clock
  std::vector<KlvItem> items;    ///< in packet order
  std::optional<KlvChecksum> checksum;
  std::string problem;      ///< where decoding stopped early; empty if it did not
  std::int64_t leap_s = 0;  ///< what its time stamp lacks to UTC, s: by item 136 of the stream, 0 or less
  /// Of values that earlier packets sent (klv_hold.h): how far the camera may have moved and turned since.
  double moved_m = 0;
  double turned_deg = 0;

  /// The last item of this number that has a value; nullptr if there is none.
  [[nodiscard]] const KlvItem* Find(int number) const {
    const KlvItem* found = nullptr;
    for (const KlvItem& item : items) {
      if (item.number == number && !std::holds_alternative<std::monostate>(item.value)) found = &item;
    }
    return found;
  }

  /// The numeric value of that item; std::nullopt if there is none or it is not a number.
  [[nodiscard]] std::optional<double> Number(int number) const {
    const KlvItem* item = Find(number);
    return item == nullptr ? std::nullopt : item->Number();
  }
};

}  // namespace victorious
