// telemetry/: camera states as a CSV table: a header line, then one row per time; columns by name
// (docs/formats/telemetry.md). Reader and writer.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/camera_state.h"

namespace victorious {

struct CameraRows {
  std::vector<CameraState> states;    ///< as read, each with its own vertical datum
  std::vector<std::string> warnings;  ///< one line per row that was skipped (WarningList)
  int rows = 0;                       ///< rows in the table, skipped ones included
};

/// Whether the first line has at least two of the columns time_s, latitude_deg, longitude_deg, altitude_m.
[[nodiscard]] bool LooksLikeCameraCsv(std::string_view text);

/// Rows that cannot be read are skipped with a warning.
/// Errors: kInvalidArgument for a table that lacks a time or position column or has no readable row.
[[nodiscard]] Expected<CameraRows> ParseCameraCsv(std::string_view text);

/// An additional column.
struct CsvColumn {
  std::string name;
  std::vector<std::string> cells;  ///< one per state
};

/// The table as text: the eight required columns, the optional columns that any state has or that `always` names, then
/// `more`. Unknown values are empty cells.
[[nodiscard]] std::string FormatCameraCsv(std::span<const CameraState> states, std::span<const CsvColumn> more = {},
                                          std::span<const std::string_view> always = {});

}  // namespace victorious
