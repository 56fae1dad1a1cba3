// A single picture from a file (PNG, JPEG and whatever else OpenCV reads).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"

namespace victorious {

struct Image {
  cv::Mat bgr;    ///< CV_8UC3, upright (EXIF orientation applied)
  cv::Mat alpha;  ///< CV_8UC1, 0 transparent to 255 opaque; empty where the file has no alpha channel
};

/// Reads and decodes a picture; 16-bit pictures come down to 8. At most 2^28 pixels.
/// Errors: kNotFound, kInvalidArgument (empty file, a folder), kDataLoss (not a picture that can be decoded).
Expected<Image> ReadImage(const std::filesystem::path& path);

/// The same from bytes in memory; `name` is for the error's text.
Expected<Image> DecodeImage(std::span<const std::byte> bytes, const std::string& name);

/// Luma as the features see it: CV_8UC1.
cv::Mat GreyFromBgr(const cv::Mat& bgr);

}  // namespace victorious
