// The images of a folder that VideoReader opens as a video.
#pragma once

#include <filesystem>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

/// The images by natural order of their names ("9.png" before "10.png"), which is the order of the frames; other files
/// are left out. Frame times count from the first image that can be read.
/// Errors: those of the file system; kInvalidArgument for a folder without images.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> ListImages(const std::filesystem::path& folder);

}  // namespace victorious
