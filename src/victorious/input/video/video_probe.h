// Whether a file begins as a video or an image that VideoReader opens: by its first bytes alone, without a decoder.
#pragma once

#include <filesystem>

namespace victorious {

/// Reads at most 1 MB. False for a file that cannot be read, and for sound without a picture.
[[nodiscard]] bool BeginsAsVideo(const std::filesystem::path& file);

}  // namespace victorious
