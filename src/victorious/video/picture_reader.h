// Private to video/: the VideoReader of a folder of images, or of a single one.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// The pictures of a folder by their names' natural order ("9.png" before "10.png"); other files are passed over.
Expected<std::unique_ptr<VideoReader>> OpenFolder(const std::filesystem::path& folder,
                                                  const VideoReaderOptions& options);

/// A picture as a video of one frame.
Expected<std::unique_ptr<VideoReader>> OpenPicture(const std::filesystem::path& file,
                                                   const VideoReaderOptions& options);

/// Whether the file begins as a picture does and not as a video.
[[nodiscard]] bool IsPicture(const std::filesystem::path& file);

/// Digits compare as numbers, everything else as bytes; a strict weak order, total over distinct names.
[[nodiscard]] bool NaturalLess(std::string_view a, std::string_view b);

}  // namespace victorious
