// Of image/ and video/: parses the header of an image file before any decoder runs. It bounds the size, extracts the
// EXIF orientation, and defines the list of formats that are passed to OpenCV. OpenCV builds may support many more
// formats through GDAL and GDCM: some of these open further files, some terminate the program on damaged input.
// Therefore only formats that OpenCV identifies by fixed first bytes are accepted. WebP is refused, because OpenCV
// passes a damaged WebP file on to those libraries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "victorious/input/image/orientation.h"

namespace victorious {

enum class ImageFormat { kPng, kJpeg, kTiff, kBmp, kPnm };

/// Name of a format: "png", "jpeg", …
[[nodiscard]] std::string_view Name(ImageFormat format);

/// Contents of the header, unchecked.
struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  std::uint32_t width = 0;   ///< px, as stored
  std::uint32_t height = 0;  ///< px, as stored
  Orientation orientation = Orientation::kUpright;
  bool cut_off = false;                  ///< true for a PNG or JPEG without its end marker
  std::span<const std::byte> exif = {};  ///< of a JPEG: the EXIF segment, from "Exif"; part of the given bytes
  std::span<const std::byte> xmp = {};   ///< of a JPEG: the XMP packet, XML; part of the given bytes
};

/// Identifies the format by the first bytes (32 suffice); std::nullopt if it is none of these.
[[nodiscard]] std::optional<ImageFormat> DetectImageFormat(std::span<const std::byte> bytes);

/// Parses the header; of a JPEG the bytes before the image data suffice. Returns std::nullopt for an unknown format or
/// a header without a size. The values are those of the file, unchecked.
[[nodiscard]] std::optional<ImageHeader> ReadImageHeader(std::span<const std::byte> bytes);

}  // namespace victorious
