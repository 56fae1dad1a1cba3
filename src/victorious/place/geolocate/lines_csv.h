// Reads lines of sight from CSV (format: docs/formats/locate.md).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

struct LineOfSightTable {
  std::vector<LineOfSight> lines;     ///< in the order of the valid rows
  std::vector<bool> row_is_valid;     ///< one per row
  std::vector<std::string> problems;  ///< one per invalid row: file and line, what is wrong, what would be right
};

/// Parses CSV text. Ignores empty lines and unknown columns. Safe for arbitrary bytes. Errors: kInvalidArgument, one
/// line with `name` and the line number, if the header lacks a column or no row is valid.
[[nodiscard]] Expected<LineOfSightTable> ParseLinesOfSight(std::string_view text, std::string_view name);

/// As above, from a file. Errors: also those of ReadFile.
[[nodiscard]] Expected<LineOfSightTable> ReadLinesOfSight(const std::filesystem::path& path);

}  // namespace victorious
