// Where an image lies in the input of a network, and the tiles by which a large image is looked at.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/network/detector_settings.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// An image in the input of a network.
struct PlacedImage {
  cv::Mat input;       ///< CV_8UC3, BGR, of the input's size
  double scale_x = 1;  ///< px of the input a px of the image
  double scale_y = 1;
  int left_px = 0;  ///< of the image in the input
  int top_px = 0;

  /// A box of the input in px of the image.
  [[nodiscard]] Box ToImage(const Box& box) const;
};

/// @param bgr  CV_8UC3, not empty
[[nodiscard]] PlacedImage PlaceImage(const cv::Mat& bgr, const DetectorSettings& settings);

/// Tiles that cover an image: equally spaced, of one size, each overlaps the next by at least this part of its side.
/// @param tile  no larger than needed: clipped to the image
[[nodiscard]] std::vector<cv::Rect> TilesOf(cv::Size image, cv::Size tile, double min_overlap_fraction);

}  // namespace victorious
