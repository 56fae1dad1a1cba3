// Text that others wrote: its lines, the cells of a table, numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

[[nodiscard]] std::string_view WithoutByteOrderMark(std::string_view text);

[[nodiscard]] std::string_view WithoutBlanks(std::string_view text);

/// Takes a line off the front, without its end ("\n", "\r\n").
[[nodiscard]] std::string_view TakeLine(std::string_view& text);

/// The cells between commas, without blanks around them. A cell in double quotes may hold commas, and quotes doubled
/// (RFC 4180, but for line ends).
[[nodiscard]] std::vector<std::string> SplitRow(std::string_view line);

/// Takes a number off the front, after blanks; nothing if none stands there, and for infinities and NaN.
[[nodiscard]] std::optional<double> TakeNumber(std::string_view& text);

/// The number that is the whole of `text` but for blanks around it.
[[nodiscard]] std::optional<double> NumberIn(std::string_view text);

}  // namespace victorious
