// Reads and writes single images: PNG, JPEG, TIFF, BMP and PNM, through OpenCV's decoders. Other formats are refused,
// because some decoders that OpenCV may be built with open further files or terminate the program.
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
  cv::Mat alpha;  ///< CV_8UC1, 0 transparent to 255 opaque; empty if the file has no alpha channel
};

/// Reads and decodes an image of at most 2^28 pixels; 16-bit samples are reduced to 8 bits.
/// Errors: kNotFound, kInvalidArgument (empty file, a folder), kDataLoss (not a decodable image), kUnsupported (too
/// large, floating point).
[[nodiscard]] Expected<Image> ReadImage(const std::filesystem::path& path);

/// Decodes an image from memory; `name` is the prefix of error messages. Errors: those of ReadImage.
[[nodiscard]] Expected<Image> DecodeImage(std::span<const std::byte> bytes, const std::string& name);

/// Error: kInvalidArgument unless WriteImage knows the file extension: .png, .jpg, and other common ones.
[[nodiscard]] Status CheckImageName(const std::filesystem::path& path);

/// Writes a BGR or grey image atomically; the file extension determines the format (.png, .jpg).
/// Errors: kInvalidArgument for an unknown extension or an image that its format cannot hold; those of
/// WriteFileAtomically.
[[nodiscard]] Status WriteImage(const std::filesystem::path& path, const cv::Mat& image);

/// Encodes a BGR image as JPEG, deterministically.
/// @param quality  1 to 100; 80 suffices for viewing
[[nodiscard]] Expected<std::vector<std::byte>> EncodeJpeg(const cv::Mat& bgr, int quality = 80);

/// Encodes a BGR image losslessly, as PNG.
[[nodiscard]] Expected<std::vector<std::byte>> EncodePng(const cv::Mat& bgr);

/// Returns the luma that the feature extraction uses: CV_8UC1, BT.601 weights 0.299 R + 0.587 G + 0.114 B.
cv::Mat GreyFromBgr(const cv::Mat& bgr);

}  // namespace victorious
