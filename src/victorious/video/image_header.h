// Private to video/: the head of a picture file, read before any decoder touches it. It bounds the size, finds the EXIF
// orientation, and is the list of formats that are let through to OpenCV. A build of OpenCV may know many more, by way
// of GDAL and GDCM: some open other files, some end the program on damage. Therefore only formats that OpenCV knows by
// fixed first bytes are let through: WebP is not, because a damaged one falls through to those libraries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "victorious/video/orientation.h"

namespace victorious {

enum class ImageFormat { kPng, kJpeg, kTiff, kBmp, kPnm };

/// "png", "jpeg", …
[[nodiscard]] std::string_view Name(ImageFormat format);

struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  std::uint32_t width = 0;   ///< px, as stored
  std::uint32_t height = 0;  ///< px, as stored
  Orientation orientation = Orientation::kUpright;
  bool cut_off = false;  ///< a PNG or JPEG whose end is missing
};

/// By the first bytes alone (32 are enough), however damaged the rest.
[[nodiscard]] std::optional<ImageFormat> ImageFormatOf(std::span<const std::byte> bytes);

/// Nothing if it is of none of the formats, or its size does not stand in it. The numbers are as the file says,
/// unchecked.
[[nodiscard]] std::optional<ImageHeader> ReadImageHeader(std::span<const std::byte> bytes);

}  // namespace victorious
