// Private to telemetry/: subtitles of DJI and Autel aircraft to camera states and warnings.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/input/telemetry/dji_srt.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {

/// Heights above the take-off are used where its height is known: the aircraft's own heights above the sea are often
/// wrong by tens of metres.
[[nodiscard]] DjiHeight HeightOf(const TelemetryOptions& options);

/// How subtitles are read.
[[nodiscard]] DjiReading ReadingOf(const TelemetryOptions& options);

/// Warns of a take-off far below the sea.
/// @param takeoff_m  the heights of the take-off above the sea that records imply
/// @param word       the name of the heights above the sea
void WarnOfTakeoffHeight(std::vector<double> takeoff_m, std::string_view word, const TelemetryOptions& options,
                         std::vector<std::string>& warnings);

/// The states of the subtitles, each with its own datum.
[[nodiscard]] Telemetry TelemetryFromDji(DjiSubtitles subtitles, const TelemetryOptions& options);

/// Whether a subtitle of a video has a keyword of DJI aircraft.
[[nodiscard]] bool HasDjiSubtitle(std::span<const DataPacket> packets);

/// Parses the subtitle packets of a video; a text may start with its length.
[[nodiscard]] DjiSubtitles ParseSubtitlePackets(std::span<const DataPacket> packets, const DjiReading& reading);

}  // namespace victorious
