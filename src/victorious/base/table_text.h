// Tables as programs export them: separated by semicolons or tabs, with decimal commas, in UTF-16.
#pragma once

#include <string>
#include <string_view>

namespace victorious {

/// The text in UTF-8 without a byte order mark; UTF-16 is known by its mark, or by the zero bytes of its first letters.
/// Half pairs become U+FFFD.
[[nodiscard]] std::string Utf8FromText(std::string_view bytes);

/// The table in UTF-8 with commas between the cells and decimal points, line by line (SplitRow in text.h reads its
/// rows). The header decides: a semicolon or tab separates if it is in the header and divides it into more cells than
/// commas do; then a comma in a number is a decimal comma. A first line "sep=;" of spreadsheet programs becomes
/// an empty one: the numbers of lines stay.
[[nodiscard]] std::string CommaSeparated(std::string_view bytes);

}  // namespace victorious
