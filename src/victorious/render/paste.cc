#include "victorious/render/paste.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {

void Paste(const cv::Mat& grey, const cv::Mat& mask, const Similarity2& picture_from_grey, cv::Mat& picture) {
  cv::Mat object;
  cv::Mat share;
  mask.convertTo(share, CV_32F, 1 / 255.0);
  grey.convertTo(object, CV_32F);
  object = object.mul(share);
  // Low-pass filter before downscaling (anti-aliasing).
  const double shrink = 1 / picture_from_grey.scale;
  if (shrink > 1) {
    const double sigma_px = 0.5 * std::sqrt(shrink * shrink - 1);
    cv::GaussianBlur(object, object, {}, sigma_px);
    cv::GaussianBlur(share, share, {}, sigma_px);
  }
  const Eigen::Matrix2d linear = picture_from_grey.Linear();
  const Eigen::Vector2d half(0.5, 0.5);  // in OpenCV the centre of the first pixel is at 0, here at 0.5
  const Eigen::Vector2d shift = picture_from_grey.translation + linear * half - half;
  const cv::Matx23d map(linear(0, 0), linear(0, 1), shift.x(), linear(1, 0), linear(1, 1), shift.y());
  cv::warpAffine(object, object, map, picture.size());
  cv::warpAffine(share, share, map, picture.size());
  cv::Mat background;
  picture.convertTo(background, CV_32F);
  cv::Mat pasted = object + background.mul(1 - share);
  pasted.convertTo(picture, CV_8U);
}

}  // namespace victorious
