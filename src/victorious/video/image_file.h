// A single picture from a file: PNG, JPEG, TIFF, BMP or PNM. Decoding is OpenCV's; formats beyond these are
// refused, because some decoders that OpenCV may be built with open other files or end the program.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"

namespace victorious {

struct Image {
  cv::Mat bgr;    ///< CV_8UC3, upright (EXIF orientation applied)
  cv::Mat alpha;  ///< CV_8UC1, 0 transparent to 255 opaque; empty where the file has no alpha channel
};

/// Reads and decodes a picture; 16-bit pictures come down to 8. At most 2^28 pixels.
/// Errors: kNotFound, kInvalidArgument (empty file, a folder), kDataLoss (not a picture that can be decoded),
/// kUnsupported (too large, floating point).
Expected<Image> ReadImage(const std::filesystem::path& path);

/// The same from bytes in memory; `name` is for the error's text.
Expected<Image> DecodeImage(std::span<const std::byte> bytes, const std::string& name);

/// Writes a BGR or grey picture atomically; the format is that of the name's ending (.png, .jpg).
/// Errors: kInvalidArgument for an ending that names no format; those of WriteFileAtomically.
Status WriteImage(const std::filesystem::path& path, const cv::Mat& image);

/// A small JPEG of a BGR picture, the same bytes each time.
/// @param quality  1 to 100; 80 is enough for people to look at
Expected<std::vector<std::byte>> EncodeJpeg(const cv::Mat& bgr, int quality = 80);

/// A BGR picture without loss, as PNG.
Expected<std::vector<std::byte>> EncodePng(const cv::Mat& bgr);

/// Luma as the features see it: CV_8UC1, of the BT.601 weights 0.299 R + 0.587 G + 0.114 B.
cv::Mat GreyFromBgr(const cv::Mat& bgr);

}  // namespace victorious
