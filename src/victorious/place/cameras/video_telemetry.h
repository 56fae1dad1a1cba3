// Finds and reads the telemetry of a video: embedded in the file, or in a file beside it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/base/warning_sink.h"
#include "victorious/geometry/ground.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// True if the file is a telemetry file and not a video: by its extension or its first bytes.
[[nodiscard]] bool IsTelemetryFile(const std::string& path);

/// Reads a telemetry file (KLV, DJI subtitles, a table), a video's embedded telemetry, or that of photos: a folder or
/// one image.
/// Errors: those of reading; kInvalidArgument if the source holds no telemetry.
[[nodiscard]] Expected<Telemetry> ReadTelemetry(const std::string& source, const TelemetryOptions& options);

/// Finds a video's telemetry. Order: embedded KLV, a file beside it, embedded subtitles or the tags of a folder's
/// photos. std::nullopt if there is none.
/// @param warn  receives warnings about telemetry that cannot be read
/// Errors: those of the options.
[[nodiscard]] Expected<std::optional<Telemetry>> FindTelemetry(const std::string& video,
                                                               const TelemetryOptions& options,
                                                               const std::function<void(const std::string&)>& warn);

/// Reads the given file, else finds the video's telemetry as FindTelemetry does. std::nullopt for a live source without
/// a file. Passes warnings to `warn`.
/// @param info     of the video
/// @param consequence  the consequence to report if no state covers the video: "nothing will get a place"
/// Errors: those of ReadTelemetry for a given file, and of the options.
[[nodiscard]] Expected<std::optional<Telemetry>> LoadTelemetry(const std::string& video, const VideoInfo& info,
                                                               const std::optional<std::string>& file,
                                                               const TelemetryOptions& options,
                                                               std::string_view consequence,
                                                               const std::function<void(const std::string&)>& warn);

/// The telemetry file that was given when a video was indexed (VideoRecord::telemetry). std::nullopt: none was given,
/// it may not be opened, or it is gone; one line to `warn` says which of the last two. `warn` may be empty.
/// @param roots  that it must lie below
[[nodiscard]] std::optional<std::string> RememberedTelemetry(const std::string& file, const FileRoots& roots,
                                                             const WarningSink& warn);

/// What telemetry of a format that is not read the video has, and what to do; std::nullopt if it has none.
[[nodiscard]] std::optional<std::string> DescribeUnreadTelemetry(const VideoInfo& info);

/// Explains why no camera state is usable for any frame of a video; std::nullopt if one may be.
/// @param duration_s  of the video, if known
[[nodiscard]] std::optional<std::string> DescribeMismatch(std::span<const CameraState> states,
                                                          std::optional<double> duration_s);

/// Explains that the heights of most camera states are below the ground; std::nullopt if they are not, or if heights or
/// ground are unknown.
[[nodiscard]] std::optional<std::string> DescribeUnderground(std::span<const CameraState> states, const Ground& ground);

}  // namespace victorious
