// A KLV unit of telemetry, decoded: what its items are called, by their standard, and what they say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace victorious {

/// A list of whole numbers, or bytes that are another set, or a pack, and stay undecoded.
using KlvList = std::vector<std::uint64_t>;
using KlvRaw = std::vector<std::byte>;

/// Nothing where the item says that it has no value, or what it says cannot be read.
using KlvValue = std::variant<std::monostate, std::int64_t, std::uint64_t, double, std::string, KlvList, KlvRaw>;

struct KlvItem {
  int number = 0;         ///< by ST 0601; 0 in a universal set
  std::string label;      ///< in a universal set: the item's label, as hexadecimal digits
  std::string_view name;  ///< the standard's; "unknown" for numbers and labels that it lacks
  std::string_view unit;  ///< empty for counts and texts
  KlvValue value;
  std::string note;     ///< why there is no value, or what a set within the set holds; else empty
  bool is_set = false;  ///< a set within the set: its value stays bytes
};

enum class KlvStandard { kSt0601, kEg0104, kOther };

struct KlvChecksum {
  std::uint16_t expected = 0;  ///< as the packet says
  std::uint16_t computed = 0;

  [[nodiscard]] bool IsValid() const { return expected == computed; }
};

struct KlvPacket {
  KlvStandard standard = KlvStandard::kOther;
  std::string label;             ///< the unit's, as hexadecimal digits
  int stream = 0;                ///< the container's index; 0 for bare KLV
  std::size_t offset = 0;        ///< bytes: in the file for bare KLV, else in the container's packet
  std::optional<double> time_s;  ///< by the container, on the video's clock
  std::vector<KlvItem> items;    ///< in the order of the packet
  std::optional<KlvChecksum> checksum;
  std::string problem;  ///< where decoding stopped short; empty where it did not

  /// The last item of this number that has a value; nothing if there is none.
  [[nodiscard]] const KlvItem* Find(int number) const {
    const KlvItem* found = nullptr;
    for (const KlvItem& item : items) {
      if (item.number == number && !std::holds_alternative<std::monostate>(item.value)) found = &item;
    }
    return found;
  }

  [[nodiscard]] std::optional<double> Number(int number) const {
    const KlvItem* item = Find(number);
    if (item == nullptr) return std::nullopt;
    if (const auto* value = std::get_if<double>(&item->value)) return *value;
    if (const auto* value = std::get_if<std::uint64_t>(&item->value)) return static_cast<double>(*value);
    if (const auto* value = std::get_if<std::int64_t>(&item->value)) return static_cast<double>(*value);
    return std::nullopt;
  }
};

}  // namespace victorious
