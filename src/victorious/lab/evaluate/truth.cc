#include "victorious/lab/evaluate/truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kMaxFrame = 9007199254740992.0;  // 2^53: beyond it, doubles skip whole numbers

/// The value of `key`, or null if it is missing.
const nlohmann::json& Value(const nlohmann::json& object, const char* key) {
  static const nlohmann::json null;
  const auto at = object.find(key);
  return at == object.end() ? null : *at;
}

/// The error for a key that is missing or has a wrong value.
std::unexpected<Error> BadKey(const nlohmann::json& value, std::string_view key, std::string_view wanted) {
  return Fail(ErrorCode::kInvalidArgument, value.is_null() ? fmt::format("{} is missing: expected {}", key, wanted)
                                                           : fmt::format("{} is not {}", key, wanted));
}

Expected<double> ParseNumber(const nlohmann::json& row, const char* key) {
  const nlohmann::json& value = Value(row, key);
  if (!value.is_number()) return BadKey(value, key, "a number");
  return value.get<double>();
}

Expected<std::string> ParseText(const nlohmann::json& row, const char* key) {
  const nlohmann::json& value = Value(row, key);
  if (!value.is_string()) return BadKey(value, key, "a string");
  return value.get<std::string>();
}

Expected<std::int64_t> ParseFrame(const nlohmann::json& row) {
  constexpr std::string_view kWanted = "a whole number >= 0";
  const nlohmann::json& value = Value(row, "frame");
  if (!value.is_number()) return BadKey(value, "frame", kWanted);
  const double frame = value.get<double>();
  if (!(frame >= 0 && frame <= kMaxFrame && frame == std::floor(frame))) return BadKey(value, "frame", kWanted);
  return static_cast<std::int64_t>(frame);
}

Expected<Box> ParseBox(const nlohmann::json& row) {
  constexpr std::string_view kWanted = "[x, y, width, height] in pixels";
  const nlohmann::json& value = Value(row, "box");
  if (!value.is_array() || value.size() != 4) return BadKey(value, "box", kWanted);
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!value[i].is_number()) return BadKey(value, "box", kWanted);
    numbers[i] = value[i].get<double>();
  }
  const Box box{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (box.width < 0 || box.height < 0) return BadKey(value, "box", "[x, y, width, height] with width and height >= 0");
  return box;
}

Expected<std::optional<ViewDirection>> ParseView(const nlohmann::json& row) {
  const nlohmann::json& value = Value(row, "view");
  if (value.is_null()) return std::nullopt;
  if (!value.is_object()) return BadKey(value, "view", "an object with azimuth_deg and off_nadir_deg");
  if (value.empty()) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(const double azimuth_deg, ParseNumber(value, "azimuth_deg"));
  VICTORIOUS_ASSIGN_OR_RETURN(const double off_nadir_deg, ParseNumber(value, "off_nadir_deg"));
  return ViewDirection{RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(off_nadir_deg)};
}

/// std::nullopt if the key is missing or null.
Expected<std::optional<double>> ParseOptionalNumber(const nlohmann::json& row, const char* key) {
  if (Value(row, key).is_null()) return std::nullopt;
  return ParseNumber(row, key);
}

Expected<std::optional<GeodeticPoint>> ParsePlace(const nlohmann::json& row) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto latitude_deg, ParseOptionalNumber(row, "latitude_deg"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto longitude_deg, ParseOptionalNumber(row, "longitude_deg"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto altitude_m, ParseOptionalNumber(row, "altitude_m"));
  if (!latitude_deg || !longitude_deg || !altitude_m) return std::nullopt;
  return GeodeticPoint{RadiansFromDegrees(*latitude_deg), RadiansFromDegrees(*longitude_deg), *altitude_m};
}

Expected<TruthRow> ParseRow(std::string_view line) {
  const Expected<nlohmann::json> parsed = ParseStrictJson(line);
  if (!parsed || !parsed->is_object()) return Fail(ErrorCode::kInvalidArgument, "not a JSON object on one line");
  const nlohmann::json& json = *parsed;
  TruthRow row;
  VICTORIOUS_ASSIGN_OR_RETURN(row.frame, ParseFrame(json));
  VICTORIOUS_ASSIGN_OR_RETURN(row.object, ParseText(json, "object"));
  VICTORIOUS_ASSIGN_OR_RETURN(row.model, ParseText(json, "model"));
  VICTORIOUS_ASSIGN_OR_RETURN(row.box, ParseBox(json));
  VICTORIOUS_ASSIGN_OR_RETURN(row.visible, ParseNumber(json, "visible"));
  VICTORIOUS_ASSIGN_OR_RETURN(row.view, ParseView(json));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto time_s, ParseOptionalNumber(json, "time_s"));
  row.time_s = time_s.value_or(0);
  VICTORIOUS_ASSIGN_OR_RETURN(row.place, ParsePlace(json));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto heading_deg, ParseOptionalNumber(json, "heading_deg"));
  if (heading_deg) row.heading_rad = RadiansFromDegrees(*heading_deg);
  return row;
}

}  // namespace

Expected<std::vector<TruthRow>> ParseTruth(std::string_view text, std::string_view name) {
  std::vector<TruthRow> rows;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    auto row = ParseRow(line);
    if (!row) return std::unexpected(std::move(row).error().WithContext(fmt::format("{}:{}", name, number)));
    rows.push_back(*std::move(row));
  }
  return rows;
}

Expected<std::vector<TruthRow>> ReadTruth(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  return ParseTruth(text, path.string());
}

}  // namespace victorious
