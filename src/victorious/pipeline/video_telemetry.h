// The telemetry of a video: out of the file itself, or out of one that lies beside it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/telemetry/telemetry.h"
#include "victorious/types/camera_state.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// Whether it is a file of telemetry, and no video: by its first bytes, or by an ending that no video has.
[[nodiscard]] bool IsTelemetryFile(const std::string& path);

/// Reads a file of telemetry (KLV, DJI subtitles, a table), or a video's own.
/// Errors: those of reading; kInvalidArgument for what holds no telemetry.
Expected<Telemetry> ReadTelemetry(const std::string& source, const TelemetryOptions& options);

/// A video's own telemetry (KLV), or a file's beside it, or its own subtitles; nothing where there is none.
/// @param tell  what is there and cannot be read
/// Errors: those of the options.
Expected<std::optional<Telemetry>> FindTelemetry(const std::string& video, const TelemetryOptions& options,
                                                 const std::function<void(const std::string&)>& tell);

/// What tells of a video: a file that was named, else what is in it or beside it; nothing of a live source without a
/// file. What is not as it should be is told.
/// @param info     of the video
/// @param useless  what follows where no state serves any of its frames: "nothing will get a place"
/// Errors: those of ReadTelemetry for a file, and of the options.
Expected<std::optional<Telemetry>> TelemetryOf(const std::string& video, const VideoInfo& info,
                                               const std::optional<std::string>& file, const TelemetryOptions& options,
                                               std::string_view useless,
                                               const std::function<void(const std::string&)>& tell);

/// Why no state of the camera can serve any frame of a video, in words; nothing where one may.
/// @param duration_s  the video's, where it is known
[[nodiscard]] std::optional<std::string> WhyOfNoUse(std::span<const CameraState> states,
                                                    std::optional<double> duration_s);

/// Of `flight.mp4`: `flight.SRT`, `flight.srt`, `flight.mp4.telemetry.csv`, `flight.telemetry.csv`, whichever is there
/// first.
[[nodiscard]] std::optional<std::filesystem::path> TelemetryBeside(const std::string& video);

}  // namespace victorious
