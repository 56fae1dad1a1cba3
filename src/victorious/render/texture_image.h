// Private to render/: a texture's picture. Runs only where a crash does no harm (isolated.h).
#pragma once

#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"

namespace victorious {

/// CV_8UC4 (blue, green, red, alpha) of a PNG, JPEG, BMP or TGA. TGA has no mark of its own: bytes of none of the
/// others are taken for it where `name` ends in .tga. Errors: kUnsupported (another format, wider or higher than
/// kMaxTextureSide), kDataLoss.
Expected<cv::Mat> DecodeTexture(std::span<const std::byte> bytes, const std::string& name);

}  // namespace victorious
