// Telemetry as a table: a header, then a row for each moment, columns by name (docs/formats/telemetry.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/camera_state.h"

namespace victorious {

struct CameraRows {
  std::vector<CameraState> states;    ///< as they stand, each with its own datum
  std::vector<std::string> warnings;  ///< rows that were left out
  int rows = 0;
};

/// Whether the first line looks like such a table's header.
[[nodiscard]] bool LooksLikeCameraCsv(std::string_view text);

/// Rows that cannot be read are left out and told.
/// Errors: kInvalidArgument for a table without the columns of time and place, or without a row that can be read.
Expected<CameraRows> ParseCameraCsv(std::string_view text);

/// A column beside those of the states.
struct CsvColumn {
  std::string name;
  std::vector<std::string> cells;  ///< one a state
};

/// The eight columns always, the optional ones where a state has them or `always` names them, then `more`; what is
/// unknown is an empty cell.
[[nodiscard]] std::string CameraCsvText(std::span<const CameraState> states, std::span<const CsvColumn> more = {},
                                        std::span<const std::string_view> always = {});

/// "ellipsoid", "egm96", "egm2008", "takeoff".
[[nodiscard]] std::string_view Name(VerticalDatum datum);
[[nodiscard]] std::optional<VerticalDatum> VerticalDatumOf(std::string_view name);

}  // namespace victorious
