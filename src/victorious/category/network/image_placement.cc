#include "victorious/category/network/image_placement.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// The starts of intervals of `side` that cover `length`.
std::vector<int> StartsOf(int length, int side, double min_overlap_fraction) {
  const int range = length - side;
  if (range <= 0) return {0};
  const double max_step = std::max(1.0, side * (1 - min_overlap_fraction));
  const int steps = static_cast<int>(std::ceil(range / max_step));
  std::vector<int> starts;
  for (int i = 0; i <= steps; ++i) {
    starts.push_back(static_cast<int>(std::lround(static_cast<double>(range) * i / steps)));
  }
  return starts;
}

}  // namespace

Box PlacedImage::ToImage(const Box& box) const {
  return {(box.x - left_px) / scale_x, (box.y - top_px) / scale_y, box.width / scale_x, box.height / scale_y};
}

PlacedImage PlaceImage(const cv::Mat& bgr, const DetectorSettings& settings) {
  PlacedImage placed;
  const cv::Size size(settings.width, settings.height);
  const int interpolation = settings.resampling == ImageResampling::kArea ? cv::INTER_AREA : cv::INTER_LINEAR;
  placed.scale_x = static_cast<double>(size.width) / bgr.cols;
  placed.scale_y = static_cast<double>(size.height) / bgr.rows;
  if (settings.fit == ImageFit::kSqueeze) {
    cv::resize(bgr, placed.input, size, 0, 0, interpolation);
    return placed;
  }
  placed.scale_x = placed.scale_y = std::min(placed.scale_x, placed.scale_y);
  const cv::Size inner(std::clamp(static_cast<int>(bgr.cols * placed.scale_x), 1, size.width),
                       std::clamp(static_cast<int>(bgr.rows * placed.scale_y), 1, size.height));
  if (settings.fit == ImageFit::kLetterbox) {
    placed.left_px = (size.width - inner.width) / 2;
    placed.top_px = (size.height - inner.height) / 2;
  }
  placed.input = cv::Mat(size, CV_8UC3, cv::Scalar::all(settings.border));
  cv::Mat part = placed.input(cv::Rect({placed.left_px, placed.top_px}, inner));
  cv::resize(bgr, part, inner, 0, 0, interpolation);
  return placed;
}

std::vector<cv::Rect> TilesOf(cv::Size image, cv::Size tile, double min_overlap_fraction) {
  const cv::Size side(std::min(image.width, tile.width), std::min(image.height, tile.height));
  std::vector<cv::Rect> tiles;
  for (const int y : StartsOf(image.height, side.height, min_overlap_fraction)) {
    for (const int x : StartsOf(image.width, side.width, min_overlap_fraction)) {
      tiles.emplace_back(cv::Point(x, y), side);
    }
  }
  return tiles;
}

}  // namespace victorious
