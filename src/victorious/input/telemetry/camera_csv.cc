#include "victorious/input/telemetry/camera_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/enum_text.h"
#include "victorious/base/table_text.h"
#include "victorious/base/text.h"
#include "victorious/base/utc.h"
#include "victorious/base/warning_list.h"
#include "victorious/geometry/angles.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

constexpr std::array<std::string_view, 4> kPlaceColumns = {"time_s", "latitude_deg", "longitude_deg", "altitude_m"};
constexpr std::array<std::string_view, 5> kDistortionColumns = {"k1", "k2", "p1", "p2", "k3"};
using Columns = std::map<std::string, std::size_t, std::less<>>;

// The cells of one row, by column name.
class Row {
 public:
  Row(const Columns& columns, std::vector<std::string> cells) : columns_(columns), cells_(std::move(cells)) {}

  [[nodiscard]] std::string_view Text(std::string_view column) const {
    const auto at = columns_.find(column);
    return at != columns_.end() && at->second < cells_.size() ? std::string_view(cells_[at->second])
                                                              : std::string_view();
  }

  /// @return std::nullopt for an empty cell; an error for a cell that is not a number within [min, max]
  [[nodiscard]] Expected<std::optional<double>> Number(std::string_view column, double min, double max) const {
    const std::string_view text = Text(column);
    if (text.empty()) return std::nullopt;
    const auto number = ParseNumber(text);
    if (number && *number >= min && *number <= max) return number;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is \"{}\": must be a number from {} to {}", column, text.substr(0, 40), min, max));
  }

  [[nodiscard]] Expected<double> Required(std::string_view column, double min, double max) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto number, Number(column, min, max));
    if (!number) return Fail(ErrorCode::kInvalidArgument, fmt::format("{} is empty", column));
    return *number;
  }

 private:
  const Columns& columns_;
  std::vector<std::string> cells_;
};

Expected<std::optional<Attitude>> ParseAttitude(const Row& row) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto yaw_deg, row.Number("yaw_deg", -720, 720));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto pitch_deg, row.Number("pitch_deg", -90, 90));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto roll_deg, row.Number("roll_deg", -720, 720));
  if (!yaw_deg || !pitch_deg || !roll_deg) return std::nullopt;
  return Attitude{RadiansFromDegrees(*yaw_deg), RadiansFromDegrees(*pitch_deg), RadiansFromDegrees(*roll_deg)};
}

Expected<VerticalDatum> ParseDatum(const Row& row) {
  const std::string_view name = row.Text("vertical_datum");
  if (name.empty()) return VerticalDatum::kEllipsoid;
  if (const auto datum = FromText(kVerticalDatumTexts, name)) return *datum;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("vertical_datum is \"{}\": must be ellipsoid, egm96, egm2008, takeoff or unknown",
                          name.substr(0, 40)));
}

// Missing coefficients are 0; std::nullopt if all are missing.
Expected<std::optional<std::array<double, 5>>> ParseDistortion(const Row& row) {
  std::optional<std::array<double, 5>> distortion;
  for (std::size_t i = 0; i < kDistortionColumns.size(); ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto number, row.Number(kDistortionColumns[i], -1e3, 1e3));
    if (!number) continue;
    if (!distortion) distortion.emplace();
    (*distortion)[i] = *number;
  }
  return distortion;
}

Expected<CameraState> ParseState(const Row& row) {
  constexpr double kMaxTime_s = 1e9;      // seconds: thirty years
  constexpr double kMaxAltitude_m = 1e7;  // metres
  CameraState state;
  VICTORIOUS_ASSIGN_OR_RETURN(state.time_s, row.Required("time_s", -kMaxTime_s, kMaxTime_s));
  VICTORIOUS_ASSIGN_OR_RETURN(const double latitude_deg, row.Required("latitude_deg", -90, 90));
  VICTORIOUS_ASSIGN_OR_RETURN(const double longitude_deg, row.Required("longitude_deg", -180, 360));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto altitude_m, row.Number("altitude_m", -kMaxAltitude_m, kMaxAltitude_m));
  state.place.altitude_m = altitude_m.value_or(0);
  state.place.latitude_rad = RadiansFromDegrees(latitude_deg);
  state.place.longitude_rad = RadiansFromDegrees(longitude_deg > 180 ? longitude_deg - 360 : longitude_deg);
  VICTORIOUS_ASSIGN_OR_RETURN(state.attitude, ParseAttitude(row));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto hfov_deg, row.Number("hfov_deg", 0, 180));
  if (hfov_deg && *hfov_deg > 0 && *hfov_deg < 180) state.hfov_rad = RadiansFromDegrees(*hfov_deg);
  VICTORIOUS_ASSIGN_OR_RETURN(state.sigma_position_m, row.Number("sigma_position_m", 0, kMaxAltitude_m));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto sigma_deg, row.Number("sigma_attitude_deg", 0, 180));
  if (sigma_deg) state.sigma_attitude_rad = RadiansFromDegrees(*sigma_deg);
  VICTORIOUS_ASSIGN_OR_RETURN(state.datum, ParseDatum(row));
  if (!altitude_m) state.datum = VerticalDatum::kUnknown;
  VICTORIOUS_ASSIGN_OR_RETURN(state.distortion, ParseDistortion(row));
  state.utc_us = ParseUtc(row.Text("utc"));
  return state;
}

// Whether a row has numbers beyond the cells of the header, as decimal commas cause; a comment may be there.
bool HasMore(const std::vector<std::string>& cells, std::size_t columns) {
  return cells.size() > columns &&
         std::ranges::any_of(cells.begin() + static_cast<std::ptrdiff_t>(columns), cells.end(),
                             [](const std::string& cell) { return ParseNumber(cell).has_value(); });
}

std::string Cell(const std::optional<double>& value) { return value ? fmt::format("{:.6f}", *value) : std::string(); }

std::optional<double> Degrees(const std::optional<double>& radians) {
  return radians ? std::optional(DegreesFromRadians(*radians)) : std::nullopt;
}

// A column that is written only if a state has a value for it.
struct OptionalColumn {
  std::string name;
  std::string (*cell)(const CameraState&);
};

template <std::size_t I>
std::string DistortionCell(const CameraState& state) {
  return state.distortion ? fmt::format("{:.9g}", (*state.distortion)[I]) : std::string();
}

const std::array<OptionalColumn, 9>& OptionalColumns() {
  static const std::array<OptionalColumn, 9> columns = {{
      {"sigma_position_m", [](const CameraState& state) { return Cell(state.sigma_position_m); }},
      {"sigma_attitude_deg", [](const CameraState& state) { return Cell(Degrees(state.sigma_attitude_rad)); }},
      {"utc", [](const CameraState& state) { return state.utc_us ? FormatUtc(*state.utc_us) : std::string(); }},
      {"vertical_datum",
       [](const CameraState& state) { return std::string(ToText(kVerticalDatumTexts, state.datum)); }},
      {"k1", &DistortionCell<0>},
      {"k2", &DistortionCell<1>},
      {"k3", &DistortionCell<4>},
      {"p1", &DistortionCell<2>},
      {"p2", &DistortionCell<3>},
  }};
  return columns;
}

std::string RequiredCells(const CameraState& state) {
  const auto& attitude = state.attitude;
  const bool has_height = state.datum != VerticalDatum::kUnknown;
  return fmt::format("{:.6f},{:.10f},{:.10f},{},{},{},{},{}", state.time_s,
                     DegreesFromRadians(state.place.latitude_rad), DegreesFromRadians(state.place.longitude_rad),
                     has_height ? fmt::format("{:.4f}", state.place.altitude_m) : "",
                     attitude ? Cell(DegreesFromRadians(attitude->yaw_rad)) : "",
                     attitude ? Cell(DegreesFromRadians(attitude->pitch_rad)) : "",
                     attitude ? Cell(DegreesFromRadians(attitude->roll_rad)) : "", Cell(Degrees(state.hfov_rad)));
}

// The names of the columns: the first line that is not empty. Sets its number, from 1.
std::vector<std::string> TakeHeader(std::string_view& text, int& line) {
  std::string_view header;
  while (!text.empty() && TrimBlanks(header).empty()) {
    header = TakeLine(text);
    ++line;
  }
  return SplitRow(header);
}

}  // namespace

bool LooksLikeCameraCsv(std::string_view bytes) {
  constexpr std::size_t kHeadSize = 8192;
  const std::string head = CommaSeparated(bytes.substr(0, kHeadSize));
  std::string_view text = head;
  int line = 0;
  const std::vector<std::string> names = TakeHeader(text, line);
  return std::ranges::count_if(names, [](const std::string& name) {
           return std::ranges::find(kPlaceColumns, LowerCase(name)) != kPlaceColumns.end();
         }) >= 2;
}

Expected<CameraRows> ParseCameraCsv(std::string_view bytes) {
  const std::string table = CommaSeparated(bytes);
  std::string_view text = table;
  Columns columns;
  std::size_t at = 0;
  int header_line = 0;
  for (const std::string& name : TakeHeader(text, header_line)) columns.emplace(LowerCase(name), at++);
  for (const std::string_view name : kPlaceColumns) {
    if (!columns.contains(name)) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("the header has no column {}: a telemetry table needs {}",
                                                           name, "time_s, latitude_deg, longitude_deg, altitude_m"));
    }
  }
  CameraRows rows;
  WarningList skipped;
  int bad_times = 0;
  for (int line = header_line + 1; !text.empty(); ++line) {
    const std::string_view cells = TakeLine(text);
    if (TrimBlanks(cells).empty()) continue;
    ++rows.rows;
    std::vector<std::string> values = SplitRow(cells);
    if (HasMore(values, at)) {
      skipped.Add(
          fmt::format("line {} is skipped: it has {} cells, the header {}: decimal commas need a semicolon or a "
                      "tab between the cells",
                      line, values.size(), at));
      continue;
    }
    const Row row(columns, std::move(values));
    auto state = ParseState(row);
    if (state) {
      bad_times += !row.Text("utc").empty() && !state->utc_us ? 1 : 0;
      rows.states.push_back(*std::move(state));
    } else {
      skipped.Add(fmt::format("line {} is skipped: {}", line, state.error().message));
    }
  }
  rows.warnings = skipped.Lines();
  if (bad_times > 0) {
    rows.warnings.push_back(
        fmt::format("utc of {} rows is ignored: must be an ISO 8601 time such as 2026-05-27T13:14:22.911Z", bad_times));
  }
  if (!rows.states.empty()) return rows;
  return Fail(ErrorCode::kInvalidArgument, rows.warnings.empty()
                                               ? "the table has a header but no rows"
                                               : fmt::format("no row can be read: {}", rows.warnings[0]));
}

std::string FormatCameraCsv(std::span<const CameraState> states, std::span<const CsvColumn> more,
                            std::span<const std::string_view> always) {
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg";
  std::vector<const OptionalColumn*> used;
  for (const OptionalColumn& column : OptionalColumns()) {
    if (std::ranges::find(always, column.name) != always.end() ||
        std::ranges::any_of(states, [&](const CameraState& state) { return !column.cell(state).empty(); })) {
      used.push_back(&column);
      text += "," + column.name;
    }
  }
  for (const CsvColumn& column : more) text += "," + column.name;
  text += "\n";
  for (std::size_t i = 0; i < states.size(); ++i) {
    text += RequiredCells(states[i]);
    for (const OptionalColumn* column : used) text += "," + column->cell(states[i]);
    for (const CsvColumn& column : more) text += "," + column.cells[i];
    text += "\n";
  }
  return text;
}

}  // namespace victorious
