// Private to telemetry/: numbers, lines and moments out of text that others wrote.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

/// The number that is the whole of `text` but for blanks around it; nothing for others, infinities and NaN.
[[nodiscard]] std::optional<double> NumberIn(std::string_view text);

/// Takes a number off the front, after blanks; nothing if none stands there.
[[nodiscard]] std::optional<double> TakeNumber(std::string_view& text);

[[nodiscard]] std::string_view WithoutBlanks(std::string_view text);

/// Takes a line off the front, without its end ("\n", "\r\n").
[[nodiscard]] std::string_view TakeLine(std::string_view& text);

/// The cells between commas, without blanks around them.
[[nodiscard]] std::vector<std::string_view> SplitAtCommas(std::string_view line);

/// ISO 8601 in UTC ("2026-05-27T13:14:22.911Z", also with a blank for the T or without the Z) as microseconds since
/// 1970; nothing for what is no such moment.
[[nodiscard]] std::optional<std::int64_t> MicrosecondsOfUtc(std::string_view text);

/// The other way; years beyond 9999 do not occur in what MicrosecondsOfUtc gives.
[[nodiscard]] std::string UtcText(std::int64_t microseconds);

}  // namespace victorious
