#include "victorious/input/telemetry/klv_packets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/input/telemetry/eg0104.h"
#include "victorious/input/telemetry/st0601.h"

namespace victorious {
namespace {

KlvPacket DecodeUnit(const KlvUnit& unit) {
  if (IsSt0601Label(unit.label)) return DecodeSt0601(unit);
  if (IsEg0104Label(unit.label)) return DecodeEg0104(unit);
  return {.label = HexText(unit.label), .offset = unit.offset};
}

// The header of an MPEG-TS metadata cell (ISO 13818-1, 2.12.4): service, number, flags, length of the content.
constexpr std::size_t kCellHeader = 5;

bool IsCell(Bytes bytes) {
  return bytes.size() > kCellHeader && ReadUnsigned(bytes.subspan(3, 2)) == bytes.size() - kCellHeader;
}

// Reassembles the KLV units of one stream from the pieces that the container delivers.
class UnitAssembler {
 public:
  /// @return the data that is complete with this packet, with the time of its first piece
  std::vector<DataPacket> Take(const DataPacket& packet) {
    const Bytes bytes(packet.bytes);
    const Bytes content = IsCell(bytes) ? bytes.subspan(kCellHeader) : bytes;
    std::vector<DataPacket> complete;
    DataPacket joined = packet;
    if (partial_ && !StartsWithUniversalLabel(content) && partial_->bytes.size() < kMaxBytes) {
      joined = *std::exchange(partial_, std::nullopt);
      joined.bytes.insert(joined.bytes.end(), content.begin(), content.end());
    }
    if (partial_) complete.push_back(*std::exchange(partial_, std::nullopt));
    if (const auto cut_off = SplitKlv(joined.bytes).cut_off) {
      partial_ = joined;
      const auto at = static_cast<std::ptrdiff_t>(*cut_off);
      partial_->bytes.erase(partial_->bytes.begin(), partial_->bytes.begin() + at);
      joined.bytes.resize(*cut_off);
    }
    if (!joined.bytes.empty()) complete.push_back(std::move(joined));
    return complete;
  }

  /// The incomplete unit, if any.
  [[nodiscard]] const std::optional<DataPacket>& partial() const { return partial_; }

 private:
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 20;  // far above the size of any telemetry unit

  std::optional<DataPacket> partial_;
};

KlvPackets DecodeUnits(Bytes bytes) {
  KlvUnits split = SplitKlv(bytes);
  KlvPackets decoded{.packets = {}, .warnings = std::move(split.warnings)};
  for (const KlvUnit& unit : split.units) decoded.packets.push_back(DecodeUnit(unit));
  return decoded;
}

// The leap seconds that the stream sent last, or else will send first: a flight has one number of them. UTC is never
// ahead of a time that counts without leap seconds, so that a positive number counts those to be taken off.
void SetLeapSeconds(std::vector<KlvPacket>& packets) {
  std::map<int, std::int64_t> latest_s;  // by stream
  const auto set = [&](KlvPacket& packet) {
    const bool is_damaged = packet.checksum && !packet.checksum->IsValid();
    if (const auto leap_s = is_damaged ? std::nullopt : LeapSeconds(packet); leap_s) {
      latest_s[packet.stream] = -std::abs(*leap_s);
    }
    if (const auto found = latest_s.find(packet.stream); found != latest_s.end()) packet.leap_s = found->second;
  };
  for (auto packet = packets.rbegin(); packet != packets.rend(); ++packet) set(*packet);
  for (KlvPacket& packet : packets) set(packet);
}

// Decodes a container packet and appends the result, with its stream and time.
void Decode(const DataPacket& packet, KlvPackets& all) {
  KlvPackets some = DecodeUnits(Bytes(packet.bytes));
  for (KlvPacket& decoded : some.packets) {
    decoded.stream = packet.stream;
    decoded.time_s = packet.time_s;
  }
  std::ranges::move(some.packets, std::back_inserter(all.packets));
  const std::string when = packet.time_s ? fmt::format(" at {:.2f} s", *packet.time_s) : "";
  all.warnings.Append(fmt::format("stream {}{}: ", packet.stream, when), some.warnings);
}

}  // namespace

KlvPackets DecodeKlv(Bytes bytes) {
  KlvPackets decoded = DecodeUnits(bytes);
  SetLeapSeconds(decoded.packets);
  return decoded;
}

KlvPackets DecodeKlv(std::span<const DataPacket> packets) {
  KlvPackets all;
  std::map<int, UnitAssembler> joiners;  // by stream
  for (const DataPacket& packet : packets) {
    if (packet.kind != DataKind::kKlv) continue;
    for (const DataPacket& complete : joiners[packet.stream].Take(packet)) Decode(complete, all);
  }
  for (const auto& [stream, joiner] : joiners) {
    if (joiner.partial()) Decode(*joiner.partial(), all);
  }
  SetLeapSeconds(all.packets);
  return all;
}

std::optional<std::int64_t> PrecisionTime(const KlvPacket& packet) {
  constexpr int kPrecisionTimeStamp = 2;
  constexpr std::uint64_t kYear10000 = 253'402'300'800'000'000;
  for (const KlvItem& item : packet.items) {
    if (item.number != kPrecisionTimeStamp && item.name != eg0104::kTimeStamp) continue;
    if (const auto* time_us = std::get_if<std::uint64_t>(&item.value);
        time_us != nullptr && *time_us > 0 && *time_us < kYear10000) {
      return static_cast<std::int64_t>(*time_us);
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> LeapSeconds(const KlvPacket& packet) {
  constexpr int kLeapSeconds = 136;
  constexpr double kMost = 1000;  // there were 27 in the 45 years to 2017
  const auto leap_s = packet.Number(kLeapSeconds);
  if (!leap_s || std::abs(*leap_s) > kMost) return std::nullopt;
  return static_cast<std::int64_t>(*leap_s);
}

std::optional<std::int64_t> UtcTime(const KlvPacket& packet) {
  constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;
  const auto own_us = PrecisionTime(packet);
  return own_us ? std::optional(*own_us + packet.leap_s * kMicrosecondsPerSecond) : std::nullopt;
}

}  // namespace victorious
