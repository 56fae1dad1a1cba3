// Private to telemetry/: moments as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace victorious {

/// ISO 8601 ("2026-05-27T13:14:22.911Z", also with a blank for the T, with a zone as in +02:00, or without one, which
/// is taken for UTC) as microseconds since 1970; nothing for what is no such moment.
[[nodiscard]] std::optional<std::int64_t> MicrosecondsOfUtc(std::string_view text);

/// The other way; years beyond 9999 do not occur in what MicrosecondsOfUtc gives.
[[nodiscard]] std::string UtcText(std::int64_t microseconds);

}  // namespace victorious
