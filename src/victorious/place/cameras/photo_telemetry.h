// The telemetry of a folder of drone photos, or of one photo: EXIF and XMP (input/telemetry/photo.h).
#pragma once

#include <istream>
#include <optional>
#include <string>

#include "victorious/base/error.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {

/// True for a folder, and for a JPEG file: of images only these have tags that are read.
[[nodiscard]] bool IsOfImages(const std::string& video);

/// The head of a JPEG file without what ReadPhotoMetadata does not need: the segments of tags and the frame header.
/// Others, as of previews and of raw temperatures, are skipped and not read. Empty if it is no JPEG.
[[nodiscard]] std::string ReadPhotoHead(std::istream& file);

/// Reads the tags of all images. Each state has the time of its frame.
/// @param video       a folder or an image
/// @param frame_rate  of the folder, frames/s (VideoReaderOptions::folder_frame_rate)
/// @return std::nullopt if no image has a position
/// Errors: those of VideoReader and of the options. Cost: reads the tags of every JPEG, some 64 KiB at most, and the
/// first image.
[[nodiscard]] Expected<std::optional<Telemetry>> ReadPhotoTelemetry(const std::string& video, double frame_rate,
                                                                    const TelemetryOptions& options);

}  // namespace victorious
