#include "victorious/recognize/upright_part.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "victorious/geometry/similarity.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

int RoundUpToEven(double value) { return 2 * static_cast<int>(std::ceil(value / 2)); }

}  // namespace

Vector2d UprightPart::ToFrame(const Vector2d& in_part) const {
  const Similarity2 turned{.scale = 1 / scale, .rotation_rad = lean_rad};
  return centre_px + turned.Apply(in_part - centre_in_part_px());
}

Vector2d UprightPart::FromFrame(const Vector2d& in_frame) const {
  const Similarity2 turned{.scale = scale, .rotation_rad = -lean_rad};
  return centre_in_part_px() + turned.Apply(in_frame - centre_px);
}

UprightPart UprightPart::AtHalfScale() const {
  UprightPart half{.grey = {}, .scale = scale / 2, .lean_rad = lean_rad, .centre_px = centre_px};
  if (!grey.empty()) cv::resize(grey, half.grey, grey.size() / 2, 0, 0, cv::INTER_AREA);
  return half;
}

UprightPart CutUpright(const cv::Mat& grey, const Vector2d& centre_px, const cv::Size2d& size_px, double scale,
                       double lean_rad) {
  UprightPart made{.grey = {}, .scale = scale, .lean_rad = lean_rad, .centre_px = centre_px};
  const cv::Size size(RoundUpToEven(size_px.width * scale), RoundUpToEven(size_px.height * scale));
  // Reduced without aliasing: the frame around the part is averaged first, then turned.
  const double c = std::cos(lean_rad);
  const double s = std::sin(lean_rad);
  const Vector2d reach_px(0.5 * (std::abs(c) * size.width + std::abs(s) * size.height + 4) / scale,
                          0.5 * (std::abs(s) * size.width + std::abs(c) * size.height + 4) / scale);
  const Vector2d first_px = centre_px - reach_px;
  const Vector2d end_px = centre_px + reach_px;
  const cv::Rect around =
      cv::Rect(cv::Point(static_cast<int>(std::floor(first_px.x())), static_cast<int>(std::floor(first_px.y()))),
               cv::Point(static_cast<int>(std::ceil(end_px.x())), static_cast<int>(std::ceil(end_px.y())))) &
      cv::Rect({0, 0}, grey.size());
  if (around.empty()) return made;
  const cv::Size scaled_size(std::max(1, static_cast<int>(std::lround(around.width * scale))),
                             std::max(1, static_cast<int>(std::lround(around.height * scale))));
  cv::Mat scaled;
  cv::resize(grey(around), scaled, scaled_size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  const Vector2d ratio(static_cast<double>(scaled_size.width) / around.width,
                       static_cast<double>(scaled_size.height) / around.height);
  // Pixel indices, whose centres lie 0.5 further: scaled = ratio * (centre - corner + R (part - centre) / scale).
  const Eigen::Matrix2d linear = ratio.asDiagonal() * (Eigen::Matrix2d() << c, -s, s, c).finished() / scale;
  const Vector2d corner(around.x, around.y);
  const Vector2d half(0.5, 0.5);
  const Vector2d middle(0.5 * size.width, 0.5 * size.height);
  const Vector2d shift = ratio.cwiseProduct(centre_px - corner) - linear * (middle - half) - half;
  const cv::Matx23d scaled_from_part(linear(0, 0), linear(0, 1), shift.x(), linear(1, 0), linear(1, 1), shift.y());
  cv::warpAffine(scaled, made.grey, scaled_from_part, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return made;
}

}  // namespace victorious
