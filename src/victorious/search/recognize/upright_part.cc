#include "victorious/search/recognize/upright_part.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "victorious/geometry/similarity.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

cv::Rect RectBetween(const Vector2d& first_px, const Vector2d& end_px) {
  return {cv::Point(static_cast<int>(std::floor(first_px.x())), static_cast<int>(std::floor(first_px.y()))),
          cv::Point(static_cast<int>(std::ceil(end_px.x())), static_cast<int>(std::ceil(end_px.y())))};
}

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

const cv::Mat& FramePyramid::LevelFor(double scale) const {
  const double steps = std::floor(-kLevelsPerOctave * std::log2(scale) + 1e-9);
  if (!(steps >= 1)) return grey_;
  const std::size_t level = std::min(static_cast<std::size_t>(steps), kLevels) - 1;
  std::call_once(once_[level], [&] {
    const double shrunk = std::exp2(-static_cast<double>(level + 1) / kLevelsPerOctave);
    const cv::Size size(std::max(1, static_cast<int>(std::lround(grey_.cols * shrunk))),
                        std::max(1, static_cast<int>(std::lround(grey_.rows * shrunk))));
    cv::resize(grey_, levels_[level], size, 0, 0, cv::INTER_AREA);
  });
  return levels_[level];
}

UprightPart CutUpright(const FramePyramid& frame, const Vector2d& centre_px, const cv::Size2d& size_px, double scale,
                       double lean_rad) {
  UprightPart made{.grey = {}, .scale = scale, .lean_rad = lean_rad, .centre_px = centre_px};
  const cv::Size size(RoundUpToEven(size_px.width * scale), RoundUpToEven(size_px.height * scale));
  const double c = std::cos(lean_rad);
  const double s = std::sin(lean_rad);
  const Vector2d reach_px(0.5 * (std::abs(c) * size.width + std::abs(s) * size.height + 4) / scale,
                          0.5 * (std::abs(s) * size.width + std::abs(c) * size.height + 4) / scale);
  const cv::Size whole = frame.frame().size();
  const cv::Rect around = RectBetween(centre_px - reach_px, centre_px + reach_px) & cv::Rect({0, 0}, whole);
  if (around.empty()) return made;
  // What is averaged or enlarged first, and then turned: a level of the frame, or the frame around the part.
  cv::Mat source;
  Vector2d corner = Vector2d::Zero();  // of the source, in the frame
  Vector2d ratio;                      // pixels of the source per pixel of the frame
  if (scale < 1) {
    source = frame.LevelFor(scale);
    ratio = {static_cast<double>(source.cols) / whole.width, static_cast<double>(source.rows) / whole.height};
  } else {
    const cv::Size enlarged(std::max(1, static_cast<int>(std::lround(around.width * scale))),
                            std::max(1, static_cast<int>(std::lround(around.height * scale))));
    cv::resize(frame.frame()(around), source, enlarged, 0, 0, cv::INTER_CUBIC);
    corner = {around.x, around.y};
    ratio = {static_cast<double>(enlarged.width) / around.width, static_cast<double>(enlarged.height) / around.height};
  }
  // Pixel indices, whose centres lie 0.5 further: source = ratio * (centre - corner + R (part - middle) / scale).
  const Eigen::Matrix2d linear = ratio.asDiagonal() * (Eigen::Matrix2d() << c, -s, s, c).finished() / scale;
  const Vector2d half(0.5, 0.5);
  const Vector2d middle(0.5 * size.width, 0.5 * size.height);
  const Vector2d shift = ratio.cwiseProduct(centre_px - corner) - linear * (middle - half) - half;
  const cv::Matx23d source_from_part(linear(0, 0), linear(0, 1), shift.x(), linear(1, 0), linear(1, 1), shift.y());
  cv::warpAffine(source, made.grey, source_from_part, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return made;
}

}  // namespace victorious
