#include "victorious/object/render/paste.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {

void Paste(const cv::Mat& grey, const cv::Mat& mask, const Similarity2& image_from_grey, cv::Mat& image) {
  cv::Mat object;
  cv::Mat coverage;
  mask.convertTo(coverage, CV_32F, 1 / 255.0);
  grey.convertTo(object, CV_32F);
  object = object.mul(coverage);
  // Low-pass filter before downscaling (anti-aliasing).
  const double shrink = 1 / image_from_grey.scale;
  if (shrink > 1) {
    const double sigma_px = 0.5 * std::sqrt(shrink * shrink - 1);
    cv::GaussianBlur(object, object, {}, sigma_px);
    cv::GaussianBlur(coverage, coverage, {}, sigma_px);
  }
  const Eigen::Matrix2d linear = image_from_grey.Linear();
  const Eigen::Vector2d half(0.5, 0.5);  // in OpenCV the centre of the first pixel is at 0, here at 0.5
  const Eigen::Vector2d shift = image_from_grey.translation + linear * half - half;
  const cv::Matx23d map(linear(0, 0), linear(0, 1), shift.x(), linear(1, 0), linear(1, 1), shift.y());
  cv::warpAffine(object, object, map, image.size());
  cv::warpAffine(coverage, coverage, map, image.size());
  cv::Mat background;
  image.convertTo(background, CV_32F);
  cv::Mat pasted = object + background.mul(1 - coverage);
  pasted.convertTo(image, CV_8U);
}

}  // namespace victorious
