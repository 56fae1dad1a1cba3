#include "victorious/track/cut_out.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/track/cell_features.h"

namespace victorious {

RotatedBox RotatedBox::Scaled(double factor) const { return {centre, width * factor, height * factor, rotation_rad}; }

Box RotatedBox::EllipseBounds() const {
  const double c = std::cos(rotation_rad);
  const double s = std::sin(rotation_rad);
  const double across = std::hypot(width * c, height * s);
  const double down = std::hypot(width * s, height * c);
  return {centre.x() - across / 2, centre.y() - down / 2, across, down};
}

RotatedBox ToRotatedBox(const Box& box) {
  return {{box.x + box.width / 2, box.y + box.height / 2}, box.width, box.height, 0};
}

cv::Size CellAlignedSize(double width, double height, double area_px2) {
  const double factor = std::sqrt(area_px2 / std::max(1.0, width * height));
  // Extreme aspect ratios are limited.
  const auto side = [&](double length_px) {
    return kCell_px * std::clamp(static_cast<int>(std::lround(length_px * factor / kCell_px)), 2, 64);
  };
  return {side(width), side(height)};
}

ImagePyramid::ImagePyramid(const cv::Mat& image) {
  VICTORIOUS_CHECK(!image.empty());
  constexpr int kMinSide_px = 32;
  levels_.push_back(image);
  while (std::min(levels_.back().cols, levels_.back().rows) >= kMinSide_px) {
    const cv::Mat& last = levels_.back();
    cv::Mat half;  // an even number of pixels: each level is exactly half
    cv::resize(last(cv::Rect(0, 0, last.cols / 2 * 2, last.rows / 2 * 2)), half, {last.cols / 2, last.rows / 2}, 0, 0,
               cv::INTER_AREA);
    levels_.push_back(half);
  }
}

cv::Mat CropRotated(const ImagePyramid& image, const RotatedBox& box, cv::Size size) {
  VICTORIOUS_CHECK(!image.empty());
  // The coarsest level whose pixels are no larger than those of the crop.
  const double px_per_out = std::max(1.0, std::min(box.width / size.width, box.height / size.height));
  const std::size_t level = std::min(static_cast<std::size_t>(std::log2(px_per_out)), image.count() - 1);
  const double level_from_image = std::ldexp(1.0, -static_cast<int>(level));
  // From the crop's pixels to the level's. In OpenCV the origin is the first pixel's centre.
  const double c = std::cos(box.rotation_rad);
  const double s = std::sin(box.rotation_rad);
  const Eigen::Matrix2d turn = (Eigen::Matrix2d() << c, -s, s, c).finished();
  const Eigen::Matrix2d linear =
      level_from_image * turn * Eigen::DiagonalMatrix<double, 2>(box.width / size.width, box.height / size.height);
  const Eigen::Vector2d from_middle(0.5 - size.width / 2.0, 0.5 - size.height / 2.0);
  const Eigen::Vector2d first = level_from_image * box.centre + linear * from_middle - Eigen::Vector2d(0.5, 0.5);
  const cv::Matx23d map(linear(0, 0), linear(0, 1), first.x(), linear(1, 0), linear(1, 1), first.y());
  cv::Mat out;
  cv::warpAffine(image[level], out, map, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace victorious
