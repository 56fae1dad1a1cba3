// Private to video/: the VideoReader for a folder of images or a single image.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {

/// Opens a folder as a video: its images by natural order of their names ("9.png" before "10.png"); other files are
/// ignored. Errors: those of VideoReader::Open.
[[nodiscard]] Expected<std::unique_ptr<VideoReader>> OpenImageFolder(const std::filesystem::path& folder,
                                                                     const VideoReaderOptions& options);

/// Opens a single image as a video of one frame. Errors: those of VideoReader::Open.
[[nodiscard]] Expected<std::unique_ptr<VideoReader>> OpenImage(const std::filesystem::path& file,
                                                               const VideoReaderOptions& options);

/// Returns true if the first bytes identify an image format (and the extension is not that of Motion JPEG).
[[nodiscard]] bool IsImageFile(const std::filesystem::path& file);

/// Compares names: runs of digits as numbers, everything else as bytes. A strict weak order, total over distinct names.
[[nodiscard]] bool NaturalLess(std::string_view a, std::string_view b);

}  // namespace victorious
