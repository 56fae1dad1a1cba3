// The telemetry file beside a video.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace victorious {

/// Of `flight.mp4` the first that exists of `flight.SRT`, `flight.srt`, `flight.mp4.telemetry.csv`,
/// `flight.telemetry.csv`.
[[nodiscard]] std::optional<std::filesystem::path> FindTelemetryFile(const std::string& video);

}  // namespace victorious
