#include "victorious/place/geolocate/lines_csv.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/table_text.h"
#include "victorious/base/text.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

struct Column {
  std::string_view name;
  double least;
  double most;
  std::string_view unit;
  bool required;
};

enum : std::size_t {
  kTime,
  kLatitude,
  kLongitude,
  kAltitude,
  kAzimuth,
  kElevation,
  kRange,
  kSigma,
  kSigmaRange,
  kCount
};

constexpr double kMaxDistanceM = 1e7;  // no object on Earth is visible beyond it
constexpr double kMinPositive = 1e-6;  // minimum of values that must be > 0

constexpr std::array<Column, kCount> kColumns = {{
    {"time_s", -1e12, 1e12, "s", true},
    {"latitude_deg", -90, 90, "degrees", true},
    {"longitude_deg", -180, 360, "degrees", true},
    {"altitude_m", -kMaxDistanceM, kMaxDistanceM, "metres", true},
    {"azimuth_deg", -360, 360, "degrees", true},
    {"elevation_deg", -90, 90, "degrees", true},
    {"range_m", kMinPositive, kMaxDistanceM, "metres", false},
    {"sigma_deg", kMinPositive, 90, "degrees", false},
    {"sigma_range_m", kMinPositive, kMaxDistanceM, "metres", false},
}};

// The content of a cell for a one-line message: truncated, without control characters.
std::string PrintableCell(std::string_view cell) {
  constexpr std::size_t kMaxLength = 40;
  std::string shown(cell.substr(0, kMaxLength));
  std::ranges::replace_if(shown, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  return cell.size() > kMaxLength ? shown + "..." : shown;
}

// The index of each known column in the file.
using ColumnIndices = std::array<std::optional<std::size_t>, kCount>;

Expected<ColumnIndices> ParseHeader(std::string_view line) {
  const std::vector<std::string> names = SplitRow(line);
  ColumnIndices indices;
  for (std::size_t at = 0; at < names.size(); ++at) {
    const auto* const column = std::ranges::find(kColumns, LowerCase(names[at]), &Column::name);
    if (column == kColumns.end()) continue;
    auto& position = indices[static_cast<std::size_t>(column - kColumns.begin())];
    if (position)
      return Fail(ErrorCode::kInvalidArgument, fmt::format("column {} occurs twice: keep one", column->name));
    position = at;
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    if (indices[i] || !kColumns[i].required) continue;
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("no column {}: the first line must name at least the columns time_s,latitude_deg,longitude_deg,"
                    "altitude_m,azimuth_deg,elevation_deg",
                    kColumns[i].name));
  }
  return indices;
}

Expected<std::optional<double>> ParseCell(const Column& column, std::string_view cell) {
  if (cell.empty() && !column.required) return std::nullopt;
  const auto value = ParseNumber(cell);
  if (value && *value >= column.least && *value <= column.most) return value;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} is \"{}\": must be a number of {} from {} to {}", column.name, PrintableCell(cell),
                          column.unit, column.least, column.most));
}

std::optional<double> Radians(std::optional<double> degrees) {
  if (!degrees) return std::nullopt;
  return RadiansFromDegrees(*degrees);
}

Expected<LineOfSight> ParseRow(std::string_view line, const ColumnIndices& indices) {
  const std::vector<std::string> cells = SplitRow(line);
  std::array<std::optional<double>, kCount> values;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (!indices[i]) continue;
    if (*indices[i] >= cells.size()) {
      if (!kColumns[i].required) continue;
      return Fail(ErrorCode::kInvalidArgument, fmt::format("no {}: the line ends after {} of at least {} cells",
                                                           kColumns[i].name, cells.size(), *indices[i] + 1));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(values[i], ParseCell(kColumns[i], cells[*indices[i]]));
  }
  return LineOfSight{
      .time_s = *values[kTime],
      .camera = {RadiansFromDegrees(*values[kLatitude]), RadiansFromDegrees(*values[kLongitude]), *values[kAltitude]},
      .azimuth_rad = RadiansFromDegrees(*values[kAzimuth]),
      .elevation_rad = RadiansFromDegrees(*values[kElevation]),
      .range_m = values[kRange],
      .sigma_rad = Radians(values[kSigma]),
      .sigma_range_m = values[kSigmaRange]};
}

}  // namespace

Expected<LineOfSightTable> ParseLinesOfSight(std::string_view bytes, std::string_view name) {
  const std::string whole = CommaSeparated(bytes);
  std::string_view text = whole;
  std::optional<ColumnIndices> indices;
  LineOfSightTable table;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = TakeLine(text);
    if (TrimBlanks(line).empty()) continue;
    const std::string where = fmt::format("{}:{}", name, number);
    if (!indices) {
      auto header = ParseHeader(line);
      if (!header) return std::unexpected(std::move(header).error().WithContext(where));
      indices = *header;
      continue;
    }
    auto row = ParseRow(line, *indices);
    table.row_is_valid.push_back(row.has_value());
    if (row) {
      table.lines.push_back(*std::move(row));
    } else {
      table.problems.push_back(std::move(row).error().WithContext(where).message);
    }
  }
  if (!table.lines.empty()) return table;
  return Fail(ErrorCode::kInvalidArgument,
              table.problems.empty()
                  ? fmt::format("{}: no lines of sight: must have a header and at least one row below it", name)
                  : table.problems.front());
}

Expected<LineOfSightTable> ReadLinesOfSight(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  return ParseLinesOfSight(text, path.string());
}

}  // namespace victorious
