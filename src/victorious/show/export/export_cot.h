// Exports geolocated objects as Cursor-on-Target 2.0 events, for ATAK, WinTAK and TAK servers.
//
// Source: the event schema of MITRE (Event-PUBLIC.xsd, version 2.0). Its `ce` and `le` are, where they are errors, one
// standard deviation of a normal distribution. `le` is that of the height. `ce` is that of the circular distribution
// with the CE90 of the place:
//
//   ce = CE90 / sqrt(2 ln 10) = CE90 / 2.146
#pragma once

#include <cstdint>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"

namespace victorious {

/// How long an event is valid: of an object that stands, from its generation; of one that moves, from its last
/// sighting.
inline constexpr std::int64_t kCotStandingUs = std::int64_t{24} * 3600 * 1'000'000;
inline constexpr std::int64_t kCotMovingUs = std::int64_t{5} * 60 * 1'000'000;

/// The type of what is named so: of unknown affiliation, by the last known word of the name ("vehicle/car", "fire
/// truck"), else something on the ground.
[[nodiscard]] std::string_view CotTypeOf(std::string_view name);

/// Error: kInvalidArgument unless the text is words of letters and digits with '-' between them.
[[nodiscard]] Status CheckCotType(std::string_view type);

/// One event per object of known place, each a line and an XML document of its own: what a TAK server takes by TCP, and
/// a datagram by UDP. Errors: those of CheckCotType.
extern const ExportFormat kCotFormat;

}  // namespace victorious
