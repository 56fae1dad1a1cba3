#include "victorious/input/image/image_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>

namespace victorious {
namespace {

// Reads integers at any offset. Bytes beyond the end read as 0, which is invalid in every format.
class ByteView {
 public:
  ByteView(std::span<const std::byte> bytes, std::endian order) : bytes_(bytes), order_(order) {}

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::uint32_t U8(std::size_t at) const {
    return at < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at]) : 0;
  }
  [[nodiscard]] std::uint32_t U16(std::size_t at) const {
    return order_ == std::endian::big ? U8(at) << 8 | U8(at + 1) : U8(at + 1) << 8 | U8(at);
  }
  [[nodiscard]] std::uint32_t U32(std::size_t at) const {
    return order_ == std::endian::big ? U16(at) << 16 | U16(at + 2) : U16(at + 2) << 16 | U16(at);
  }
  [[nodiscard]] bool Has(std::size_t at, std::string_view text) const {
    if (at > bytes_.size() || bytes_.size() - at < text.size()) return false;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (static_cast<char>(bytes_[at + i]) != text[i]) return false;
    }
    return true;
  }
  [[nodiscard]] std::span<const std::byte> From(std::size_t at) const {
    return bytes_.subspan(std::min(at, bytes_.size()));
  }
  [[nodiscard]] std::span<const std::byte> Part(std::size_t begin, std::size_t end) const {
    const std::span<const std::byte> rest = From(begin);
    return rest.first(end > begin ? std::min(end - begin, rest.size()) : 0);
  }

 private:
  std::span<const std::byte> bytes_;
  std::endian order_;
};

constexpr std::string_view kExifPrefix("Exif\0\0", 6);
constexpr std::string_view kXmpPrefix("http://ns.adobe.com/xap/1.0/\0", 29);
constexpr std::string_view kLittleEndian("II*\0", 4);
constexpr std::string_view kBigEndian("MM\0*", 4);

// Returns the value of a tag in the first directory of a TIFF structure (TIFF 6.0, section 2); EXIF has this structure.
std::optional<std::uint32_t> TiffTag(std::span<const std::byte> tiff, std::uint32_t wanted) {
  constexpr std::uint32_t kShort = 3;
  const ByteView little(tiff, std::endian::little);
  if (!little.Has(0, kLittleEndian) && !little.Has(0, kBigEndian)) return std::nullopt;
  const ByteView view(tiff, little.Has(0, kLittleEndian) ? std::endian::little : std::endian::big);
  const std::size_t directory = view.U32(4);
  const std::uint32_t entries = view.U16(directory);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    if (entry >= view.size()) return std::nullopt;
    if (view.U16(entry) == wanted) return view.U16(entry + 2) == kShort ? view.U16(entry + 8) : view.U32(entry + 8);
  }
  return std::nullopt;
}

Orientation ExifOrientation(std::span<const std::byte> exif) {
  constexpr std::uint32_t kOrientationTag = 0x0112;
  const bool prefixed = ByteView(exif, std::endian::big).Has(0, kExifPrefix);
  return OrientationFromExif(TiffTag(prefixed ? exif.subspan(kExifPrefix.size()) : exif, kOrientationTag).value_or(1));
}

std::optional<ImageHeader> ReadPng(std::span<const std::byte> bytes) {
  const ByteView view(bytes, std::endian::big);
  ImageHeader header{.format = ImageFormat::kPng, .width = view.U32(16), .height = view.U32(20), .cut_off = true};
  for (std::size_t chunk = 8; chunk < view.size(); chunk += std::size_t{12} + view.U32(chunk)) {
    if (view.Has(chunk + 4, "eXIf")) header.orientation = ExifOrientation(view.From(chunk + 8));
    if (view.Has(chunk + 4, "IEND")) header.cut_off = false;
  }
  return header;
}

std::optional<ImageHeader> ReadJpeg(std::span<const std::byte> bytes) {
  const ByteView view(bytes, std::endian::big);
  constexpr std::array kEndOfImage = {std::byte{0xFF}, std::byte{0xD9}};
  ImageHeader header{ImageFormat::kJpeg};
  std::size_t at = 2;
  while (at + 4 <= view.size()) {
    if (view.U8(at) != 0xFF) return std::nullopt;
    const std::uint32_t marker = view.U8(at + 1);
    if (marker == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    const bool table = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
    if (marker >= 0xC0 && marker <= 0xCF && !table) {  // start of frame
      header.height = view.U16(at + 5);
      header.width = view.U16(at + 7);
      header.cut_off = std::ranges::search(view.From(at), kEndOfImage).empty();
      return header;
    }
    if (marker == 0xDA) return std::nullopt;  // start of scan without a frame header
    const bool alone = marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
    const std::size_t end = at + 2 + (alone ? 0 : view.U16(at + 2));
    if (marker == 0xE1 && view.Has(at + 4, kExifPrefix)) {
      header.orientation = ExifOrientation(view.From(at + 4));
      header.exif = view.Part(at + 4, end);
    }
    if (marker == 0xE1 && view.Has(at + 4, kXmpPrefix)) header.xmp = view.Part(at + 4 + kXmpPrefix.size(), end);
    at = end;
  }
  return std::nullopt;
}

std::optional<ImageHeader> ReadTiff(std::span<const std::byte> bytes) {
  constexpr std::uint32_t kWidthTag = 256;
  constexpr std::uint32_t kHeightTag = 257;
  const auto width = TiffTag(bytes, kWidthTag);
  const auto height = TiffTag(bytes, kHeightTag);
  if (!width || !height) return std::nullopt;
  return ImageHeader{ImageFormat::kTiff, *width, *height};  // the decoder itself applies the orientation
}

std::optional<ImageHeader> ReadBmp(std::span<const std::byte> bytes) {
  const ByteView view(bytes, std::endian::little);
  constexpr std::uint32_t kOldHeaderSize = 12;
  if (view.U32(14) == kOldHeaderSize) return ImageHeader{ImageFormat::kBmp, view.U16(18), view.U16(20)};
  const auto magnitude = [](std::uint32_t bits) {  // a negative height means top-down rows
    return static_cast<std::int32_t>(bits) < 0 ? 0 - bits : bits;
  };
  return ImageHeader{ImageFormat::kBmp, magnitude(view.U32(18)), magnitude(view.U32(22))};
}

// "P5 640 480 255 ": decimal numbers, with comments from # to the end of the line.
std::optional<ImageHeader> ReadPnm(std::span<const std::byte> bytes) {
  const ByteView view(bytes, std::endian::little);
  const auto is_space = [&](std::size_t at) { return std::isspace(static_cast<int>(view.U8(at))) != 0; };
  const auto is_digit = [&](std::size_t at) { return std::isdigit(static_cast<int>(view.U8(at))) != 0; };
  std::size_t at = 2;
  const auto next_number = [&] {
    while (is_space(at) || view.U8(at) == '#') {
      if (view.U8(at) == '#') {
        while (at < view.size() && view.U8(at) != '\n') ++at;
      }
      ++at;
    }
    std::uint32_t number = 0;
    constexpr std::uint32_t kLimit = 100'000'000;
    for (; is_digit(at); ++at) number = number < kLimit ? number * 10 + (view.U8(at) - '0') : number;
    return is_space(at) || view.U8(at) == '#' ? number : 0;  // rejects "640x480", which decoders parse differently
  };
  const std::uint32_t width = next_number();
  return ImageHeader{ImageFormat::kPnm, width, next_number()};
}

}  // namespace

std::string_view Name(ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      return "png";
    case ImageFormat::kJpeg:
      return "jpeg";
    case ImageFormat::kTiff:
      return "tiff";
    case ImageFormat::kBmp:
      return "bmp";
    case ImageFormat::kPnm:
      return "pnm";
  }
  return "";
}

std::optional<ImageFormat> DetectImageFormat(std::span<const std::byte> bytes) {
  const ByteView view(bytes, std::endian::little);
  if (view.Has(0, "\x89PNG\r\n\x1a\n") && view.Has(12, "IHDR")) return ImageFormat::kPng;
  if (view.Has(0, "\xFF\xD8\xFF")) return ImageFormat::kJpeg;
  if (view.Has(0, kLittleEndian) || view.Has(0, kBigEndian)) return ImageFormat::kTiff;
  const std::uint32_t bmp_header_size = view.U32(14);
  if (view.Has(0, "BM") && bmp_header_size >= 12 && bmp_header_size <= 256) return ImageFormat::kBmp;
  const bool pnm = view.U8(0) == 'P' && view.U8(1) >= '1' && view.U8(1) <= '6';
  if (pnm && std::isspace(static_cast<int>(view.U8(2))) != 0) return ImageFormat::kPnm;
  return std::nullopt;
}

std::optional<ImageHeader> ReadImageHeader(std::span<const std::byte> bytes) {
  const auto format = DetectImageFormat(bytes);
  if (!format) return std::nullopt;
  switch (*format) {
    case ImageFormat::kPng:
      return ReadPng(bytes);
    case ImageFormat::kJpeg:
      return ReadJpeg(bytes);
    case ImageFormat::kTiff:
      return ReadTiff(bytes);
    case ImageFormat::kBmp:
      return ReadBmp(bytes);
    case ImageFormat::kPnm:
      return ReadPnm(bytes);
  }
  return std::nullopt;
}

}  // namespace victorious
