// Private to mesh/: decodes texture images. Call it only in an isolated process (base/isolated_process.h): a decoder
// may crash on hostile files.
#pragma once

#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"

namespace victorious {

/// Decodes a PNG, JPEG, BMP or TGA to CV_8UC4 (blue, green, red, alpha). TGA has no magic number: bytes that match no
/// other format are read as TGA if `name` ends in .tga. Errors: kUnsupported (another format, wider or higher than
/// kMaxTextureSide), kDataLoss.
[[nodiscard]] Expected<cv::Mat> DecodeTexture(std::span<const std::byte> bytes, const std::string& name);

}  // namespace victorious
