#include "victorious/input/image/image_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/base/file.h"
#include "victorious/base/foreign_file.h"
#include "victorious/base/text.h"
#include "victorious/input/image/grey_range.h"
#include "victorious/input/image/image_header.h"
#include "victorious/input/image/pixel_limit.h"

namespace victorious {
namespace {

std::uint64_t max_image_pixels = std::uint64_t{1} << 28;  // LimitImagePixels

// Decodes all channels as stored; empty if OpenCV cannot decode the bytes.
cv::Mat DecodeStored(std::span<const std::byte> bytes) {
  const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::byte*>(bytes.data()));
  return cv::imdecode(view, cv::IMREAD_UNCHANGED);
}

std::optional<Image> SplitAlpha(const cv::Mat& stored, GreyRange& range) {
  constexpr double kWhite = 65535;
  cv::Mat eight_bits = stored;
  if (stored.type() == CV_16UC1) {
    eight_bits = range.ToEightBits(stored, kWhite);
  } else if (stored.depth() == CV_16U) {
    stored.convertTo(eight_bits, CV_8U, 1.0 / 257.0);
  }
  Image image;
  switch (stored.channels()) {
    case 1:
      cv::cvtColor(eight_bits, image.bgr, cv::COLOR_GRAY2BGR);
      return image;
    case 2:
      cv::extractChannel(eight_bits, image.alpha, 1);
      cv::extractChannel(eight_bits, eight_bits, 0);
      cv::cvtColor(eight_bits, image.bgr, cv::COLOR_GRAY2BGR);
      return image;
    case 3:
      image.bgr = eight_bits;
      return image;
    case 4:
      cv::extractChannel(eight_bits, image.alpha, 3);
      cv::cvtColor(eight_bits, image.bgr, cv::COLOR_BGRA2BGR);
      return image;
    default:
      return std::nullopt;
  }
}

Expected<ImageHeader> ReadCheckedHeader(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.empty()) return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: the file is empty", name));
  const auto header = ReadImageHeader(bytes);
  if (!header || bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    if (const auto foreign = DescribeForeignFile(bytes))
      return Fail(ErrorCode::kUnsupported, fmt::format("{}: {}", name, *foreign));
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: not an image that can be read (PNG, JPEG, TIFF, BMP or PNM)", name));
  }
  if (header->width == 0 || header->height == 0) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: a damaged {} image, without a size", name, Name(header->format)));
  }
  if (std::uint64_t{header->width} * header->height > max_image_pixels) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: {} x {} pixels, more than the {} that can be read", name,
                                                     header->width, header->height, max_image_pixels));
  }
  if (header->cut_off) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: a {} image whose end is missing", name, Name(header->format)));
  }
  return *header;
}

std::unexpected<Error> NoMemoryFor(const ImageHeader& header, const std::string& name) {
  return Fail(ErrorCode::kUnavailable,
              fmt::format("{}: not enough memory for an image of {} x {} pixels", name, header.width, header.height));
}

// May throw cv::Exception and std::bad_alloc.
Expected<Image> DecodeChecked(std::span<const std::byte> bytes, const ImageHeader& header, const std::string& name,
                              GreyRange& range) {
  const cv::Mat stored = DecodeStored(bytes);
  if (stored.empty()) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: a damaged {} image", name, Name(header.format)));
  }
  if (stored.depth() != CV_8U && stored.depth() != CV_16U) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: pixels are neither 8-bit nor 16-bit integers", name));
  }
  auto image = SplitAlpha(stored, range);
  if (!image) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: {} channels, not 1 to 4", name, stored.channels()));
  }
  image->bgr = RotateUpright(image->bgr, header.orientation);
  // The fourth byte of a BMP pixel is almost always padding, not alpha.
  image->alpha = header.format == ImageFormat::kBmp ? cv::Mat() : RotateUpright(image->alpha, header.orientation);
  return *std::move(image);
}

}  // namespace

void LimitImagePixels(std::uint64_t pixels) { max_image_pixels = std::min(max_image_pixels, pixels); }

Expected<Image> ReadImage(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path));
  return DecodeImage(std::as_bytes(std::span(bytes)), path.string());
}

Expected<Image> DecodeImage(std::span<const std::byte> bytes, const std::string& name) {
  GreyRange range;
  return DecodeImage(bytes, name, range);
}

Expected<Image> DecodeImage(std::span<const std::byte> bytes, const std::string& name, GreyRange& range) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ImageHeader header, ReadCheckedHeader(bytes, name));
  try {
    return DecodeChecked(bytes, header, name, range);
  } catch (const std::bad_alloc&) {
    return NoMemoryFor(header, name);
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) return NoMemoryFor(header, name);
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: a damaged {} image", name, Name(header.format)));
  } catch (const std::exception&) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: a damaged {} image", name, Name(header.format)));
  }
}

namespace {

Expected<std::vector<std::byte>> Encode(const cv::Mat& bgr, const std::string& ending,
                                        const std::vector<int>& parameters) {
  std::vector<unsigned char> bytes;
  try {
    if (cv::imencode(ending, bgr, bytes, parameters)) {
      const auto encoded = std::as_bytes(std::span(bytes));
      return std::vector<std::byte>(encoded.begin(), encoded.end());
    }
  } catch (const cv::Exception&) {
    // The image is empty, or too large for the format.
  }
  return Fail(ErrorCode::kInternal,
              fmt::format("an image of {} x {} pixels cannot be encoded as {}", bgr.cols, bgr.rows, ending));
}

}  // namespace

Status CheckImageName(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 10> kExtensions = {".png", ".jpg", ".jpeg", ".bmp",  ".ppm",
                                                            ".pgm", ".pnm", ".tif",  ".tiff", ".webp"};
  if (std::ranges::find(kExtensions, LowerCase(path.extension().string())) != kExtensions.end()) return {};
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: an image's name must end in .png or .jpg", path.string()));
}

Status WriteImage(const std::filesystem::path& path, const cv::Mat& image) {
  VICTORIOUS_RETURN_IF_ERROR(CheckImageName(path));
  // Halves the size of a PNG at the cost of time; other formats ignore the parameter.
  const Expected<std::vector<std::byte>> bytes =
      Encode(image, path.extension().string(), {cv::IMWRITE_PNG_COMPRESSION, 6});
  if (!bytes) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {}: give a name that ends in .png", path.string(), bytes.error().message));
  }
  return WriteFileAtomically(path, *bytes);
}

Expected<std::vector<std::byte>> EncodeJpeg(const cv::Mat& bgr, int quality) {
  return Encode(bgr, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

Expected<std::vector<std::byte>> EncodePng(const cv::Mat& bgr) { return Encode(bgr, ".png", {}); }

cv::Mat GreyFromBgr(const cv::Mat& bgr) {
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace victorious
