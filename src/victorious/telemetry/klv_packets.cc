#include "victorious/telemetry/klv_packets.h"

#include <iterator>

#include <fmt/format.h>

#include "victorious/telemetry/eg0104.h"
#include "victorious/telemetry/st0601.h"

namespace victorious {
namespace {

constexpr std::size_t kMostWarnings = 20;

KlvPacket DecodeUnit(const KlvUnit& unit) {
  if (IsSt0601Label(unit.label)) return DecodeSt0601(unit);
  if (IsEg0104Label(unit.label)) return DecodeEg0104(unit);
  return {.label = HexText(unit.label), .offset = unit.offset};
}

}  // namespace

KlvPackets DecodeKlv(Bytes bytes) {
  KlvUnits split = SplitKlv(bytes);
  KlvPackets decoded{.packets = {}, .warnings = std::move(split.warnings)};
  for (const KlvUnit& unit : split.units) decoded.packets.push_back(DecodeUnit(unit));
  return decoded;
}

KlvPackets DecodeKlv(std::span<const DataPacket> packets) {
  KlvPackets all;
  for (const DataPacket& packet : packets) {
    if (packet.kind != DataKind::kKlv) continue;
    KlvPackets some = DecodeKlv(Bytes(packet.bytes));
    for (KlvPacket& decoded : some.packets) {
      decoded.stream = packet.stream;
      decoded.time_s = packet.time_s;
    }
    std::ranges::move(some.packets, std::back_inserter(all.packets));
    for (const std::string& warning : some.warnings) {
      if (all.warnings.size() == kMostWarnings) break;
      const std::string when = packet.time_s ? fmt::format(" at {:.2f} s", *packet.time_s) : "";
      all.warnings.push_back(fmt::format("stream {}{}: {}", packet.stream, when, warning));
    }
  }
  return all;
}

std::optional<std::int64_t> PrecisionTime(const KlvPacket& packet) {
  constexpr int kPrecisionTimeStamp = 2;
  constexpr std::uint64_t kYear10000 = 253'402'300'800'000'000;
  for (const KlvItem& item : packet.items) {
    if (item.number != kPrecisionTimeStamp && item.name != eg0104::kTimeStamp) continue;
    if (const auto* time_us = std::get_if<std::uint64_t>(&item.value); time_us != nullptr && *time_us < kYear10000) {
      return static_cast<std::int64_t>(*time_us);
    }
  }
  return std::nullopt;
}

std::string_view Name(KlvStandard standard) {
  switch (standard) {
    case KlvStandard::kSt0601:
      return "MISB ST 0601";
    case KlvStandard::kEg0104:
      return "MISB EG 0104";
    case KlvStandard::kOther:
      break;
  }
  return "other";
}

}  // namespace victorious
