// Images and image coordinates.
//
// Pixels: x to the right, y down, the left top corner of the image at (0, 0), the centre of the first pixel at
// (0.5, 0.5).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <victorious/export.h>

namespace libvictorious {

struct Point {
  double x = 0;  ///< px
  double y = 0;  ///< px
};

struct Box {
  double x = 0;       ///< left edge, px
  double y = 0;       ///< top edge, px
  double width = 0;   ///< px
  double height = 0;  ///< px
};

/// 8 bits a sample, samples in this order in memory.
enum class PixelFormat { kGrey, kBgr, kRgb, kBgra, kRgba };

/// 1, 3 or 4 bytes; 0 for a value that is no format.
LIBVICTORIOUS_EXPORT int BytesPerPixel(PixelFormat format) noexcept;

/// Pixels that belong to somebody else, who keeps them while the view is used. A function that takes a view has read it
/// when it returns.
struct ImageView {
  const std::uint8_t* pixels = nullptr;  ///< the first row: `height` rows of `width` pixels
  int width = 0;                         ///< px, 1 to 32767
  int height = 0;                        ///< px, 1 to 32767
  std::ptrdiff_t stride_bytes = 0;       ///< from a row to the next, at least width * BytesPerPixel(format)
  PixelFormat format = PixelFormat::kGrey;
};

/// Pixels of its own, which never change. Copies share them. Thread-safe.
class LIBVICTORIOUS_EXPORT Image {
 public:
  /// Reads a PNG, JPEG, TIFF, BMP or PNM file: upright, kBgr, or kBgra if it has an alpha channel.
  /// Errors: kNotFound, kInvalidArgument, kDataLoss, kUnsupported (more than 2^28 pixels, floating point).
  [[nodiscard]] static Image Read(const std::string& file);

  /// Copies the pixels. Error: kInvalidArgument for a view that describes no image.
  [[nodiscard]] static Image Copy(const ImageView& view);

  /// Valid as long as this image or a copy of it.
  [[nodiscard]] ImageView view() const noexcept;

  struct Impl;
  explicit Image(std::shared_ptr<const Impl> impl);  ///< of the library
  Image(const Image& other);
  Image(Image&& other) noexcept;
  Image& operator=(const Image& other);
  Image& operator=(Image&& other) noexcept;
  ~Image();

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace libvictorious
