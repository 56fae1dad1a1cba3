// Lines of sight as a file holds them (docs/formats/locate.md).
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/line_of_sight.h"

namespace victorious {

/// Rows in the order of the text's lines; empty lines and columns of other names are passed over. Any bytes are safe.
/// Errors: kInvalidArgument, one line with `name`, the line's number, what is wrong there and what would be right.
Expected<std::vector<LineOfSight>> ParseLinesOfSight(std::string_view text, std::string_view name);

/// The same from a file.
Expected<std::vector<LineOfSight>> ReadLinesOfSight(const std::filesystem::path& path);

}  // namespace victorious
