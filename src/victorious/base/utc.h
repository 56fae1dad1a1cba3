// UTC times: the present one, and their text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace victorious {

/// The time of the system's clock, microseconds since 1970-01-01 UTC.
[[nodiscard]] std::int64_t NowUtcMicroseconds();

/// ISO 8601 with "Z", as in "2026-05-27T13:14:22.911Z"; for the years 0 to 9999.
/// @param microseconds  since 1970-01-01 UTC
/// @param decimals      of the seconds, 1 to 6; more precise times are rounded down
[[nodiscard]] std::string FormatUtc(std::int64_t microseconds, int decimals = 6);

/// Parses an ISO 8601 time such as "2026-05-27T13:14:22.911Z". A blank may stand for the T. A zone such as +02:00 is
/// applied; without a zone the time is UTC.
/// @return microseconds since 1970-01-01 UTC; std::nullopt for any other text
[[nodiscard]] std::optional<std::int64_t> ParseUtc(std::string_view text);

}  // namespace victorious
