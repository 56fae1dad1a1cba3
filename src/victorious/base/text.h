// Parsing of external text: lines, cells of a table, numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

[[nodiscard]] std::string_view StripByteOrderMark(std::string_view text);

[[nodiscard]] std::string_view TrimBlanks(std::string_view text);

/// The text with the letters A to Z in lower case.
[[nodiscard]] std::string LowerCase(std::string_view text);

/// Removes a line from the front of `text` and returns it without its end ("\n", "\r\n").
[[nodiscard]] std::string_view TakeLine(std::string_view& text);

/// Splits a line into cells, and trims blanks. A cell in double quotes may contain separators, and doubled quotes (RFC
/// 4180, except line ends).
[[nodiscard]] std::vector<std::string> SplitRow(std::string_view line, char separator = ',');

/// Removes a number, after blanks, from the front of `text` and returns it; std::nullopt if there is no number, and for
/// infinities and NaN.
[[nodiscard]] std::optional<double> TakeNumber(std::string_view& text);

/// Parses the whole of `text`, without blanks around it, as a number; std::nullopt if it is not one.
[[nodiscard]] std::optional<double> ParseNumber(std::string_view text);

/// Parses the whole of `text` as a decimal whole number of 64 bits, "-12"; std::nullopt if it is not one.
[[nodiscard]] std::optional<std::int64_t> ParseInteger(std::string_view text);

}  // namespace victorious
