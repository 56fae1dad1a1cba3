// Lines of sight as a file holds them (docs/formats/locate.md).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

struct LineTable {
  std::vector<LineOfSight> lines;     ///< in the order of the rows that can be read
  std::vector<bool> is_read;          ///< one a row
  std::vector<std::string> problems;  ///< one a row that cannot be read: where, what is wrong, what would be right
};

/// Empty lines and columns of other names are passed over. Any bytes are safe.
/// Errors: kInvalidArgument, one line with `name` and the line's number, for a header that lacks a column, and where no
/// row can be read.
Expected<LineTable> ParseLinesOfSight(std::string_view text, std::string_view name);

/// The same from a file.
Expected<LineTable> ReadLinesOfSight(const std::filesystem::path& path);

}  // namespace victorious
