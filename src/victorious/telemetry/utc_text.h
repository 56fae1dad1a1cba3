// Private to telemetry/: UTC times as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace victorious {

/// Parses an ISO 8601 time such as "2026-05-27T13:14:22.911Z". A blank may stand for the T. A zone such as +02:00 is
/// applied; without a zone the time is UTC.
/// @return microseconds since 1970-01-01 UTC; std::nullopt for any other text
[[nodiscard]] std::optional<std::int64_t> ParseUtc(std::string_view text);

}  // namespace victorious
