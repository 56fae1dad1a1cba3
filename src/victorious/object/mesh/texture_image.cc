#include "victorious/object/mesh/texture_image.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace {

bool StartsWith(std::span<const std::byte> bytes, std::string_view mark) {
  return bytes.size() >= mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin(),
                                                   [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

// True for PNG, JPEG and BMP, by magic number. Only these are given to OpenCV: it passes unknown bytes to further
// libraries, which may open other files.
bool IsKnownToOpenCv(std::span<const std::byte> bytes) {
  constexpr std::array<std::string_view, 3> kMarks = {"\x89PNG\r\n\x1a\n", "\xFF\xD8\xFF", "BM"};
  return std::ranges::any_of(kMarks, [&](std::string_view mark) { return StartsWith(bytes, mark); });
}

// Truevision TGA 2.0: an 18-byte header, an identifier, then pixels, uncompressed or run-length encoded; true colour or
// grey.
class TgaReader {
 public:
  explicit TgaReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  // Empty if the file is damaged or of another TGA type.
  cv::Mat Read() {
    const unsigned kind = U8(2);
    const bool is_rle = kind == kColourRle || kind == kGreyRle;
    const bool grey = kind == kGrey || kind == kGreyRle;
    pixel_bytes_ = U8(16) / 8;
    const bool has_valid_depth = grey ? pixel_bytes_ == 1 : pixel_bytes_ == 3 || pixel_bytes_ == 4;
    const int width = static_cast<int>(U8(12) | U8(13) << 8);
    const int height = static_cast<int>(U8(14) | U8(15) << 8);
    const bool has_valid_kind = is_rle || kind == kColour || kind == kGrey;
    if (!has_valid_kind || U8(1) != 0 || !has_valid_depth || width < 1 || height < 1 ||
        std::max(width, height) > kMaxTextureSide) {
      return {};
    }
    at_ = 18 + U8(0);
    cv::Mat bgra(height, width, CV_8UC4);
    if (!(is_rle ? ReadRle(bgra) : ReadPlain(bgra))) return {};
    constexpr unsigned kTopRowFirst = 0x20;
    if ((U8(17) & kTopRowFirst) == 0) cv::flip(bgra, bgra, 0);
    return bgra;
  }

 private:
  static constexpr unsigned kColour = 2;
  static constexpr unsigned kGrey = 3;
  static constexpr unsigned kColourRle = 10;
  static constexpr unsigned kGreyRle = 11;

  [[nodiscard]] unsigned U8(std::size_t at) const { return at < bytes_.size() ? static_cast<unsigned>(bytes_[at]) : 0; }

  cv::Vec4b NextPixel() {
    const auto channel = [&](std::size_t i) {
      return static_cast<std::uint8_t>(U8(at_ + (pixel_bytes_ == 1 ? 0 : i)));
    };
    const cv::Vec4b pixel(channel(0), channel(1), channel(2), pixel_bytes_ == 4 ? channel(3) : 255);
    at_ += pixel_bytes_;
    return pixel;
  }

  bool ReadPlain(cv::Mat& bgra) {
    for (auto pixel = bgra.begin<cv::Vec4b>(); pixel != bgra.end<cv::Vec4b>(); ++pixel) *pixel = NextPixel();
    return at_ <= bytes_.size();
  }

  bool ReadRle(cv::Mat& bgra) {
    auto pixel = bgra.begin<cv::Vec4b>();
    const auto end = bgra.end<cv::Vec4b>();
    while (pixel != end && at_ < bytes_.size()) {
      const unsigned packet = U8(at_++);
      const bool repeats = (packet & 0x80U) != 0;
      cv::Vec4b value = NextPixel();
      for (unsigned left = (packet & 0x7FU) + 1; left > 0 && pixel != end; --left, ++pixel) {
        *pixel = value;
        if (!repeats && left > 1) value = NextPixel();
      }
    }
    return pixel == end && at_ <= bytes_.size();
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  unsigned pixel_bytes_ = 0;
};

cv::Mat DecodeStored(std::span<const std::byte> bytes) {
  const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::byte*>(bytes.data()));
  try {
    return cv::imdecode(view, cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return {};
  }
}

// Converts to BGRA with plain loops: OpenCV's colour conversion would start threads.
cv::Mat BgraFrom(const cv::Mat& stored, bool has_alpha) {
  const int channels = stored.channels();
  const bool deep = stored.depth() == CV_16U;
  cv::Mat bgra(stored.size(), CV_8UC4);
  for (int row = 0; row < stored.rows; ++row) {
    const auto value = [&](int index) -> std::uint8_t {
      return deep ? static_cast<std::uint8_t>(stored.ptr<std::uint16_t>(row)[index] / 257) : stored.ptr(row)[index];
    };
    for (int col = 0; col < stored.cols; ++col) {
      const int first = col * channels;
      const bool grey = channels < 3;
      bgra.at<cv::Vec4b>(row, col) = {value(first), value(first + (grey ? 0 : 1)), value(first + (grey ? 0 : 2)),
                                      has_alpha ? value(first + channels - 1) : std::uint8_t{255}};
    }
  }
  return bgra;
}

}  // namespace

Expected<cv::Mat> DecodeTexture(std::span<const std::byte> bytes, const std::string& name) {
  const bool known = IsKnownToOpenCv(bytes);
  if (!known && !name.ends_with(".tga") && !name.ends_with(".TGA")) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: not a PNG, JPEG, BMP or TGA image", name));
  }
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: too large for a texture", name));
  }
  const cv::Mat stored = known ? DecodeStored(bytes) : TgaReader(bytes).Read();
  if (stored.empty() || (stored.depth() != CV_8U && stored.depth() != CV_16U) || stored.channels() > 4) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: damaged, or an unsupported kind of PNG, JPEG, BMP or TGA image", name));
  }
  if (std::max(stored.cols, stored.rows) > kMaxTextureSide) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: {} x {} pixels: must be at most {} a side", name, stored.cols,
                                                     stored.rows, kMaxTextureSide));
  }
  // The fourth byte of a BMP pixel is padding in nearly all files.
  const bool has_alpha = stored.channels() % 2 == 0 && !StartsWith(bytes, "BM");
  return BgraFrom(stored, has_alpha);
}

}  // namespace victorious
