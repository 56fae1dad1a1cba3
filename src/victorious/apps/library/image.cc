#include "victorious/image.h"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "victorious/apps/library/facade.h"
#include "victorious/input/image/image_file.h"

namespace libvictorious {

struct Image::Impl {
  cv::Mat pixels;
  PixelFormat format;
};

int BytesPerPixel(PixelFormat format) noexcept {
  switch (format) {
    case PixelFormat::kGrey:
      return 1;
    case PixelFormat::kBgr:
    case PixelFormat::kRgb:
      return 3;
    case PixelFormat::kBgra:
    case PixelFormat::kRgba:
      return 4;
  }
  return 0;
}

Image Image::Read(const std::string& file) {
  return Guard([&] {
    victorious::Image read = Unwrap(victorious::ReadImage(file));
    Impl impl{.pixels = std::move(read.bgr), .format = PixelFormat::kBgr};
    if (!read.alpha.empty()) {
      cv::Mat with_alpha;
      cv::cvtColor(impl.pixels, with_alpha, cv::COLOR_BGR2BGRA);
      cv::insertChannel(read.alpha, with_alpha, 3);
      impl = {.pixels = std::move(with_alpha), .format = PixelFormat::kBgra};
    }
    return Image(std::make_shared<const Impl>(std::move(impl)));
  });
}

Image Image::Copy(const ImageView& view) {
  return Guard([&] {
    return Image(std::make_shared<const Impl>(Impl{.pixels = Unwrap(MatOf(view)).clone(), .format = view.format}));
  });
}

ImageView Image::view() const noexcept {
  ImageView view = ViewOf(impl_->pixels);
  view.format = impl_->format;
  return view;
}

Image::Image(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Image::Image(const Image& other) = default;
Image::Image(Image&& other) noexcept = default;
Image& Image::operator=(const Image& other) = default;
Image& Image::operator=(Image&& other) noexcept = default;
Image::~Image() = default;

}  // namespace libvictorious
