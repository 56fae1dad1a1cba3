#include "victorious/input/telemetry/eg0104.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>

namespace victorious {
namespace {

enum class Coding { kFloat, kUnsigned, kText };

// Labels by their second half; the first half is the same for all, except for a version.
struct UniversalItem {
  std::uint64_t code;
  std::string_view name;
  Coding coding;
  std::string_view unit = {};
};

using namespace eg0104;

constexpr std::array kItems = {
    UniversalItem{0x0101'2001'0000'0000, "Device Designation", Coding::kText},
    UniversalItem{0x0702'0101'0105'0000, kTimeStamp, Coding::kUnsigned, "us"},
    UniversalItem{0x0702'0102'0701'0000, "Event Start Date Time - UTC", Coding::kText},
    UniversalItem{0x0701'0201'0204'0200, kLatitude, Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0206'0200, kLongitude, Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0202'0000, kAltitude, Coding::kFloat, "m"},
    UniversalItem{0x0701'1001'0400'0000, "Platform Roll Angle", Coding::kFloat, "deg"},
    UniversalItem{0x0701'1001'0500'0000, "Platform Pitch Angle", Coding::kFloat, "deg"},
    UniversalItem{0x0701'1001'0600'0000, "Platform Heading Angle", Coding::kFloat, "deg"},
    UniversalItem{0x0420'0201'0108'0000, kHorizontalFieldOfView, Coding::kFloat, "deg"},
    UniversalItem{0x0420'0201'010A'0100, "Field of View (Vertical)", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0801'0100'0000, kSlantRange, Coding::kFloat, "m"},
    UniversalItem{0x0701'0902'0100'0000, "Target Width", Coding::kFloat, "m"},
    UniversalItem{0x0701'1001'0100'0000, kSensorRoll, Coding::kFloat, "deg"},
    UniversalItem{0x0701'1001'0200'0000, kAngleToNorth, Coding::kFloat, "deg"},
    UniversalItem{0x0701'1001'0300'0000, kObliquityAngle, Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0302'0000, kFrameCenterLatitude, Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0304'0000, kFrameCenterLongitude, Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0316'0000, kFrameCenterElevation, Coding::kFloat, "m"},
    UniversalItem{0x0701'0201'0307'0100, "Corner Latitude Point 1", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0308'0100, "Corner Latitude Point 2", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'0309'0100, "Corner Latitude Point 3", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'030A'0100, "Corner Latitude Point 4", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'030B'0100, "Corner Longitude Point 1", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'030C'0100, "Corner Longitude Point 2", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'030D'0100, "Corner Longitude Point 3", Coding::kFloat, "deg"},
    UniversalItem{0x0701'0201'030E'0100, "Corner Longitude Point 4", Coding::kFloat, "deg"},
    UniversalItem{0x0105'0500'0000'0000, "Episode Number", Coding::kText},
    UniversalItem{0x0420'0102'0101'0000, "Image Source Device", Coding::kText},
    UniversalItem{0x0702'0102'0101'0000, "Start Date Time - UTC", Coding::kText},
    UniversalItem{0x0701'0101'0000'0000, "Image Coordinate System", Coding::kText},
};

KlvValue DecodeFloat(Bytes bytes) {
  double value = NAN;
  if (bytes.size() == sizeof(float)) value = std::bit_cast<float>(static_cast<std::uint32_t>(ReadUnsigned(bytes)));
  if (bytes.size() == sizeof(double)) value = std::bit_cast<double>(ReadUnsigned(bytes));
  return std::isfinite(value) ? KlvValue(value) : KlvValue();
}

KlvItem DecodeItem(Bytes label, Bytes bytes) {
  KlvItem item{.number = 0, .label = HexText(label), .name = "unknown", .unit = {}, .value = {}, .note = {}};
  const std::uint64_t code = ReadUnsigned(label.subspan(kUniversalLabelSize / 2));
  const auto* spec = std::ranges::find(kItems, code, &UniversalItem::code);
  if (spec == kItems.end()) {
    item.value = KlvRaw(bytes.begin(), bytes.end());
    return item;
  }
  item.name = spec->name;
  item.unit = spec->unit;
  if (spec->coding == Coding::kText) {
    item.value = std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  } else if (spec->coding == Coding::kFloat) {
    item.value = DecodeFloat(bytes);
  } else if (!bytes.empty() && bytes.size() <= sizeof(std::uint64_t)) {
    item.value = ReadUnsigned(bytes);
  }
  if (std::holds_alternative<std::monostate>(item.value)) item.note = "not a number of a valid length for this item";
  return item;
}

}  // namespace

bool IsEg0104Label(Bytes label) {
  return label.size() == kUniversalLabelSize && HexText(label.first(7)) == "060e2b34020101" &&
         ReadUnsigned(label.subspan(kUniversalLabelSize / 2)) == 0x0E01'0102'0101'0000;
}

KlvPacket DecodeEg0104(const KlvUnit& unit) {
  KlvPacket packet{.standard = KlvStandard::kEg0104, .label = HexText(unit.label), .offset = unit.offset};
  Bytes rest = unit.value;
  while (!rest.empty()) {
    const auto at = static_cast<std::size_t>(rest.data() - unit.value.data());
    const Bytes label = rest.first(std::min(kUniversalLabelSize, rest.size()));
    rest = rest.subspan(label.size());
    const auto length = TakeBerLength(rest);
    if (label.size() < kUniversalLabelSize || !length || *length > rest.size()) {
      packet.problem = fmt::format("truncated at byte {} of {}: no item can be read there", at, unit.value.size());
      break;
    }
    const Bytes value = rest.first(static_cast<std::size_t>(*length));
    rest = rest.subspan(value.size());
    packet.items.push_back(DecodeItem(label, value));
  }
  return packet;
}

std::optional<double> FindNumber(const KlvPacket& packet, std::string_view name) {
  for (const KlvItem& item : packet.items) {
    if (item.name != name) continue;
    if (const auto number = item.Number()) return number;
  }
  return std::nullopt;
}

}  // namespace victorious
