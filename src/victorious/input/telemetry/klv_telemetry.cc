#include "victorious/input/telemetry/klv_telemetry.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/klv_camera.h"
#include "victorious/input/telemetry/klv_streams.h"

namespace victorious {
namespace {

constexpr double kSecondsPerMicrosecond = 1e-6;

// Median angle between the optical axis and the recorded frame centre above which an angle does not follow the
// standard. Consistent systems have fractions of a degree; an angle with the wrong sign or zero gives tens of degrees.
constexpr double kMaxFrameCentreError_rad = RadiansFromDegrees(2);

bool HasBadChecksum(const KlvPacket& packet) { return packet.checksum && !packet.checksum->IsValid(); }

// The offset from the packets' own clock to the video's, s: the median difference of the packets that have both times;
// if none has, such that the first packet is at time 0. std::nullopt if no packet has its own time.
std::optional<double> ClockOffset(const std::vector<KlvPacket>& packets) {
  std::vector<double> offsets;
  std::optional<std::int64_t> first_us;
  for (const KlvPacket& packet : packets) {
    if (HasBadChecksum(packet)) continue;
    const auto own_us = PrecisionTime(packet);
    if (!own_us) continue;
    if (!first_us) first_us = own_us;
    if (packet.time_s) offsets.push_back(*packet.time_s - kSecondsPerMicrosecond * static_cast<double>(*own_us));
  }
  if (!offsets.empty()) return Median(std::move(offsets));
  if (first_us) return -kSecondsPerMicrosecond * static_cast<double>(*first_us);
  return std::nullopt;
}

// Adds the states of one stream's packets. The container's time takes precedence over the packet's own. Of several
// packets with the same container time the first has that time; the others are later by their own clock.
// @return the number of states without any time
int AddKlvStates(const std::vector<KlvPacket>& packets, Telemetry& telemetry) {
  int untimed = 0;
  const auto offset_s = ClockOffset(packets);
  const KlvPacket* first_at_time = nullptr;
  for (const KlvPacket& packet : packets) {
    if (HasBadChecksum(packet)) continue;
    if (packet.time_s && !(first_at_time != nullptr && first_at_time->time_s == packet.time_s)) first_at_time = &packet;
    auto state = CameraFromKlv(packet);
    if (!state) continue;
    const auto own_us = PrecisionTime(packet);
    if (packet.time_s) {
      const auto first_us = PrecisionTime(*first_at_time);
      if (own_us && first_us) state->time_s += kSecondsPerMicrosecond * static_cast<double>(*own_us - *first_us);
    } else {
      if (!own_us || !offset_s) {
        ++untimed;
        continue;
      }
      state->time_s = *offset_s + kSecondsPerMicrosecond * static_cast<double>(*own_us);
    }
    telemetry.states.push_back(*state);
  }
  return untimed;
}

void WarnOfClock(Telemetry& telemetry) {
  const auto timed = [](const KlvPacket& packet) { return packet.time_s.has_value(); };
  if (telemetry.states.empty() || std::ranges::any_of(telemetry.packets, timed)) return;
  telemetry.warnings.emplace_back(
      "the KLV packets have no video time: the first is at time 0; shift them by time_offset_s");
}

void WarnOfLeapSeconds(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  for (const KlvPacket& packet : packets) {
    const auto leap_s = LeapSeconds(packet);
    if (!leap_s || *leap_s <= 0) continue;
    warnings.push_back(
        fmt::format("item 136 (leap seconds) is {}, but UTC is never ahead of the time stamps: it is taken as {}",
                    *leap_s, -*leap_s));
    return;
  }
}

void WarnOfChecksums(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  const auto bad = std::ranges::count_if(packets, &HasBadChecksum);
  if (bad > 0) {
    warnings.push_back(
        fmt::format("{} of {} KLV packets fail their checksum: they give no camera state", bad, packets.size()));
  }
}

void WarnOfProblems(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  const auto has_problem = [](const KlvPacket& packet) { return !packet.problem.empty(); };
  const auto first = std::ranges::find_if(packets, has_problem);
  if (first == packets.end()) return;
  warnings.push_back(fmt::format("{} of {} KLV packets are readable only in part; the first at byte {}: {}",
                                 std::ranges::count_if(packets, has_problem), packets.size(), first->offset,
                                 first->problem));
}

void WarnOfFrameCentre(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  std::vector<double> errors_rad;
  for (const KlvPacket& packet : packets) {
    if (const auto error_rad = ComputeFrameCentreError(packet)) errors_rad.push_back(*error_rad);
  }
  if (errors_rad.empty()) return;
  const double median_rad = Median(std::move(errors_rad));
  if (median_rad <= kMaxFrameCentreError_rad) return;
  warnings.push_back(
      fmt::format("the sensor angles point {:.1f} degrees (median) away from the recorded frame centre: an angle does "
                  "not follow the "
                  "standard, and positions will be wrong",
                  DegreesFromRadians(median_rad)));
}

// The items that the packets without a camera state lack, with the number of packets.
std::string DescribeMissing(std::span<const KlvPacket> packets) {
  std::vector<std::pair<std::string_view, int>> counts;  // in the order of the items
  for (const KlvPacket& packet : packets) {
    if (packet.standard != KlvStandard::kSt0601) continue;  // the names are those of ST 0601
    for (const std::string_view item : FindMissingCameraItems(std::span(&packet, 1))) {
      const auto found = std::ranges::find(counts, item, &std::pair<std::string_view, int>::first);
      if (found == counts.end()) {
        counts.emplace_back(item, 1);
      } else {
        ++found->second;
      }
    }
  }
  std::vector<std::string> texts;
  for (const auto& [item, count] : counts) texts.push_back(fmt::format("{} in {}", item, count));
  return fmt::format("{}", fmt::join(texts, ", "));
}

// @param packets  of the camera's stream, completed
void WarnOfPacketsWithoutState(std::span<const KlvPacket> packets, std::vector<std::string>& warnings) {
  std::vector<KlvPacket> without;
  std::size_t known = 0;
  for (const KlvPacket& packet : packets) {
    if (packet.standard == KlvStandard::kOther || HasBadChecksum(packet)) continue;
    ++known;
    if (!CameraFromKlv(packet)) without.push_back(packet);
  }
  if (without.empty() || without.size() == known) return;
  const std::string missing = DescribeMissing(without);
  warnings.push_back(fmt::format("{} of {} KLV packets give no camera state, also with what earlier packets sent{}{}",
                                 without.size(), known, missing.empty() ? "" : ": without ", missing));
}

void WarnOfNoCamera(Telemetry& telemetry) {
  const bool local =
      std::ranges::find(telemetry.packets, KlvStandard::kSt0601, &KlvPacket::standard) != telemetry.packets.end();
  const auto missing = local ? FindMissingCameraItems(telemetry.packets) : std::vector<std::string_view>();
  telemetry.warnings.push_back(
      fmt::format("no packet has position, height and pointing of the camera{}{}",
                  missing.empty() ? "" : "; missing or marked unknown: ", fmt::join(missing, ", ")));
}

TelemetryFormat FormatOf(KlvStandard standard) {
  switch (standard) {
    case KlvStandard::kSt0601:
      return TelemetryFormat::kSt0601;
    case KlvStandard::kEg0104:
      return TelemetryFormat::kEg0104;
    case KlvStandard::kOther:
      break;
  }
  return TelemetryFormat::kOtherKlv;
}

}  // namespace

Telemetry TelemetryFromKlv(KlvPackets decoded, double max_gap_s) {
  Telemetry telemetry;
  telemetry.warnings = decoded.warnings.Lines();
  telemetry.packets = std::move(decoded.packets);
  telemetry.records = static_cast<int>(telemetry.packets.size());
  const CameraStream camera = SelectCameraStream(telemetry.packets, max_gap_s);
  if (camera.has_others) {
    telemetry.warnings.push_back(fmt::format(
        "several KLV streams: stream {} is used{}", camera.stream,
        camera.completed_by.empty() ? "" : fmt::format(", completed by {}", fmt::join(camera.completed_by, ", "))));
  }
  const int untimed = AddKlvStates(camera.packets, telemetry);
  if (untimed > 0) {
    telemetry.warnings.push_back(fmt::format(
        "{} KLV packets have a camera state but no time, neither their own (item 2) nor the video's", untimed));
  }
  const bool has_camera = untimed > 0 || !telemetry.states.empty();
  const auto known = std::ranges::find_if(
      telemetry.packets, [](const KlvPacket& packet) { return packet.standard != KlvStandard::kOther; });
  telemetry.format = known == telemetry.packets.end() ? TelemetryFormat::kOtherKlv : FormatOf(known->standard);
  WarnOfClock(telemetry);
  WarnOfLeapSeconds(telemetry.packets, telemetry.warnings);
  WarnOfChecksums(telemetry.packets, telemetry.warnings);
  WarnOfProblems(telemetry.packets, telemetry.warnings);
  WarnOfFrameCentre(telemetry.packets, telemetry.warnings);
  WarnOfPacketsWithoutState(camera.packets, telemetry.warnings);
  if (!has_camera && known != telemetry.packets.end()) WarnOfNoCamera(telemetry);
  return telemetry;
}

}  // namespace victorious
