#include "victorious/input/image/degrade.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

void AddSensorNoise(double sigma, std::uint64_t seed, cv::Mat& bgr) {
  cv::Mat grain(bgr.size(), CV_16SC3);
  cv::RNG(seed).fill(grain, cv::RNG::NORMAL, 0.0, sigma);
  cv::add(bgr, grain, bgr, cv::noArray(), CV_8U);
}

void AddSaltAndPepper(double fraction, std::uint64_t seed, cv::Mat& bgr) {
  Random random(seed);
  const cv::Vec3b white(255, 255, 255);
  const cv::Vec3b black(0, 0, 0);
  for (int row = 0; row < bgr.rows; ++row) {
    auto* pixels = bgr.ptr<cv::Vec3b>(row);
    for (int col = 0; col < bgr.cols; ++col) {
      const double draw = random.Uniform();
      if (draw < fraction) pixels[col] = draw < fraction / 2 ? white : black;
    }
  }
}

}  // namespace

void Degrade(const DegradeOptions& options, std::uint64_t seed, cv::Mat& bgr) {
  VICTORIOUS_CHECK(bgr.type() == CV_8UC3);
  Random seeds(seed);
  const std::uint64_t grain_seed = seeds.Next();
  if (options.blur_px > 0) cv::GaussianBlur(bgr, bgr, {}, options.blur_px);
  if (options.grain > 0) AddSensorNoise(options.grain, grain_seed, bgr);
  if (options.noise > 0) AddSaltAndPepper(options.noise, seeds.Next(), bgr);
}

Status DegradeImage(const ImageDegradation& degradation, std::uint64_t seed, cv::Mat& bgr) {
  Degrade(degradation.degrade, seed, bgr);
  if (degradation.jpeg_quality == 0) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, EncodeJpeg(bgr, degradation.jpeg_quality));
  VICTORIOUS_ASSIGN_OR_RETURN(Image image, DecodeImage(bytes, "a rendered image"));
  bgr = std::move(image.bgr);
  return {};
}

}  // namespace victorious
