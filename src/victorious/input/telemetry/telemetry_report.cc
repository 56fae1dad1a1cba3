#include "victorious/input/telemetry/telemetry_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/klv.h"
#include "victorious/input/telemetry/klv_packets.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

struct ValueToJson {
  nlohmann::json operator()(std::monostate /*nothing*/) const { return nullptr; }
  nlohmann::json operator()(const std::string& text) const { return ReplaceInvalidUtf8(text); }
  nlohmann::json operator()(const KlvRaw& raw) const { return {{"hex", HexText(raw)}}; }
  template <typename T>
  nlohmann::json operator()(const T& value) const {
    return value;
  }
};

nlohmann::json ItemToJson(const KlvItem& item) {
  nlohmann::json json{{"name", item.name}, {"value", std::visit(ValueToJson(), item.value)}};
  if (item.number > 0) json["number"] = item.number;
  if (!item.label.empty()) json["label"] = item.label;
  if (!item.unit.empty()) json["unit"] = item.unit;
  if (!item.note.empty()) json["note"] = item.note;
  return json;
}

nlohmann::json ChecksumToJson(const KlvChecksum& checksum) {
  return {{"expected", checksum.expected}, {"computed", checksum.computed}, {"valid", checksum.IsValid()}};
}

nlohmann::json PacketToJson(const KlvPacket& packet) {
  nlohmann::json json{{"standard", ToText(kKlvStandardTexts, packet.standard)},
                      {"label", packet.label},
                      {"stream", packet.stream},
                      {"offset", packet.offset},
                      {"items", nlohmann::json::array()},
                      {"time_s", OrNull(packet.time_s)}};
  const auto own_us = PrecisionTime(packet);
  json["precision_time_us"] = OrNull(own_us);
  json["utc"] = own_us ? nlohmann::json(FormatUtc(*UtcTime(packet))) : nlohmann::json();
  json["checksum"] = packet.checksum ? ChecksumToJson(*packet.checksum) : nlohmann::json();
  if (!packet.problem.empty()) json["problem"] = packet.problem;
  for (const KlvItem& item : packet.items) json["items"].push_back(ItemToJson(item));
  return json;
}

nlohmann::json OptionalDegrees(const std::optional<double>& radians) {
  return radians ? nlohmann::json(DegreesFromRadians(*radians)) : nlohmann::json();
}

nlohmann::json StateToJson(const CameraState& state) {
  const auto& attitude = state.attitude;
  return {{"time_s", state.time_s},
          {"latitude_deg", DegreesFromRadians(state.place.latitude_rad)},
          {"longitude_deg", DegreesFromRadians(state.place.longitude_rad)},
          {"altitude_m",
           state.datum == VerticalDatum::kUnknown ? nlohmann::json() : nlohmann::json(state.place.altitude_m)},
          {"vertical_datum", ToText(kVerticalDatumTexts, state.datum)},
          {"yaw_deg", attitude ? nlohmann::json(DegreesFromRadians(attitude->yaw_rad)) : nlohmann::json()},
          {"pitch_deg", attitude ? nlohmann::json(DegreesFromRadians(attitude->pitch_rad)) : nlohmann::json()},
          {"roll_deg", attitude ? nlohmann::json(DegreesFromRadians(attitude->roll_rad)) : nlohmann::json()},
          {"hfov_deg", OptionalDegrees(state.hfov_rad)},
          {"sigma_position_m", OrNull(state.sigma_position_m)},
          {"sigma_attitude_deg", OptionalDegrees(state.sigma_attitude_rad)},
          {"utc", state.utc_us ? nlohmann::json(FormatUtc(*state.utc_us)) : nlohmann::json()}};
}

// "all", "none" or "12 of 40".
std::string FormatFraction(std::ptrdiff_t count, std::size_t of) {
  if (count == 0) return "none";
  return static_cast<std::size_t>(count) == of ? "all" : fmt::format("{} of {}", count, of);
}

std::string ChecksumLine(const std::vector<KlvPacket>& packets) {
  const auto with = std::ranges::count_if(packets, [](const KlvPacket& packet) { return packet.checksum.has_value(); });
  const auto good = std::ranges::count_if(
      packets, [](const KlvPacket& packet) { return packet.checksum && packet.checksum->IsValid(); });
  if (with == 0) return "checksums: none in the packets";
  return fmt::format("checksums: {} valid, {} invalid", good, with - good);
}

// The name of each nested set and the number of packets that have it, by item number.
std::map<int, std::pair<std::string_view, int>> NestedSets(const std::vector<KlvPacket>& packets) {
  std::map<int, std::pair<std::string_view, int>> sets;
  for (const KlvPacket& packet : packets) {
    std::set<int> counted;
    for (const KlvItem& item : packet.items) {
      if (!item.is_set || !counted.insert(item.number).second) continue;
      sets[item.number].first = item.name;
      ++sets[item.number].second;
    }
  }
  return sets;
}

void AddNestedSets(std::vector<std::string>& lines, const std::vector<KlvPacket>& packets) {
  std::vector<std::string> names;
  for (const auto& [number, set] : NestedSets(packets)) {
    names.push_back(fmt::format("{} ({}) in {} packets", set.first, number, set.second));
  }
  if (!names.empty()) lines.push_back(fmt::format("nested sets, not decoded: {}", fmt::join(names, ", ")));
}

void AddMissing(std::vector<std::string>& lines, const std::vector<CameraState>& states) {
  const auto all_lack = [&](auto has) { return !std::ranges::any_of(states, has); };
  if (all_lack([](const CameraState& state) { return state.attitude.has_value(); })) {
    lines.emplace_back("missing: the camera's attitude (yaw, pitch, roll)");
  }
  if (all_lack([](const CameraState& state) { return state.hfov_rad.has_value(); })) {
    lines.emplace_back("missing: the horizontal field of view");
  }
  if (all_lack([](const CameraState& state) { return state.datum != VerticalDatum::kUnknown; })) {
    lines.emplace_back("missing: the camera's height");
  } else if (all_lack([](const CameraState& state) { return state.datum == VerticalDatum::kEllipsoid; })) {
    lines.push_back(fmt::format("missing: heights above the ellipsoid (the heights refer to {})",
                                ToText(kVerticalDatumTexts, states[0].datum)));
  }
}

}  // namespace

nlohmann::json ToJson(const Telemetry& telemetry) {
  nlohmann::json json{{"format", ToText(kTelemetryFormatTexts, telemetry.format)},
                      {"records", telemetry.records},
                      {"states", nlohmann::json::array()}};
  if (!telemetry.packets.empty()) json["packets"] = nlohmann::json::array();
  for (const KlvPacket& packet : telemetry.packets) json["packets"].push_back(PacketToJson(packet));
  if (!telemetry.packets.empty()) json["nested_sets"] = nlohmann::json::array();
  for (const auto& [number, set] : NestedSets(telemetry.packets)) {
    json["nested_sets"].push_back({{"number", number}, {"name", set.first}, {"packets", set.second}});
  }
  for (const CameraState& state : telemetry.states) json["states"].push_back(StateToJson(state));
  json["warnings"] = nlohmann::json::array();
  for (const std::string& warning : telemetry.warnings) json["warnings"].push_back(ReplaceInvalidUtf8(warning));
  return json;
}

std::vector<std::string> DescribeTelemetry(const Telemetry& telemetry) {
  if (telemetry.records == 0) return {"no telemetry"};
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{}: {} records, {} camera states", ToText(kTelemetryFormatTexts, telemetry.format),
                              telemetry.records, telemetry.states.size()));
  if (!telemetry.packets.empty()) lines.push_back(ChecksumLine(telemetry.packets));
  AddNestedSets(lines, telemetry.packets);
  const std::vector<CameraState>& states = telemetry.states;
  if (states.empty()) {
    lines.emplace_back("missing: a camera state: no record has position, height and pointing together");
  } else {
    const CameraState& first = states.front();
    const std::string height =
        first.datum == VerticalDatum::kUnknown
            ? "at an unknown height"
            : fmt::format("{:.1f} m ({})", first.place.altitude_m, ToText(kVerticalDatumTexts, first.datum));
    lines.push_back(fmt::format("from {:.2f} s to {:.2f} s; first at {:.6f}, {:.6f}, {}", first.time_s,
                                states.back().time_s, DegreesFromRadians(first.place.latitude_rad),
                                DegreesFromRadians(first.place.longitude_rad), height));
    const auto complete = std::ranges::count_if(states, &CameraState::IsComplete);
    lines.push_back(fmt::format("states complete for geolocation: {}", FormatFraction(complete, states.size())));
    AddMissing(lines, states);
  }
  for (const std::string& warning : telemetry.warnings) lines.push_back("note: " + warning);
  return lines;
}

}  // namespace victorious
