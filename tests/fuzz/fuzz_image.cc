// Fuzzes the image reader.
#include <span>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/video_tools.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/input/image/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = victorious::DecodeImage(std::as_bytes(std::span(data, size)), "input");
  if (!image) {
    VICTORIOUS_CHECK(image.error().message.find('\n') == std::string::npos);
    return 0;
  }
  VICTORIOUS_CHECK(image->bgr.type() == CV_8UC3 && !image->bgr.empty());
  VICTORIOUS_CHECK(image->alpha.empty() ||
                   (image->alpha.type() == CV_8UC1 && image->alpha.size() == image->bgr.size()));
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const cv::Mat color = victorious::testing::NumberedImage(0x2C, {24, 16});
  cv::Mat alpha;
  cv::merge(std::vector<cv::Mat>{color, cv::Mat(16, 24, CV_8UC1, cv::Scalar(128))}, alpha);
  cv::Mat deep;
  color.convertTo(deep, CV_16U, 257);
  const cv::Mat grey = victorious::GreyFromBgr(color);
  std::vector<std::string> seeds;
  const auto add = [&](const char* extension, const cv::Mat& image) {
    std::vector<unsigned char> bytes;
    VICTORIOUS_CHECK(cv::imencode(extension, image, bytes));
    seeds.emplace_back(bytes.begin(), bytes.end());
  };
  for (const char* extension : {".png", ".jpg", ".tif", ".bmp", ".ppm"}) add(extension, color);
  add(".png", alpha);
  add(".png", deep);
  add(".tif", deep);
  add(".png", grey);
  add(".pgm", grey);
  // A rotated JPEG: an EXIF segment with orientation 6 after the first marker.
  constexpr std::string_view kExif(
      "\xFF\xE1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  add(".jpg", color);
  seeds.back().insert(2, kExif);
  return seeds;
}
