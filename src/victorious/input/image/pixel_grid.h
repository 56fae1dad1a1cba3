// A grid of pixel coordinates on an image, from which a person reads off a box.
#pragma once

#include <opencv2/core/mat.hpp>

namespace victorious {

/// Draws lines every 10, 20, 50, 100, ... px, so that 8 to 20 of them divide the longer side, with their coordinates in
/// pixels, and marks every fifth part of a step along the lines. The pixels between the lines stay as they are.
/// @param bgr  CV_8UC3
void DrawPixelGrid(cv::Mat& bgr);

/// The step of that grid for an image with this longer side, px.
[[nodiscard]] int PixelGridStep(int side_px);

}  // namespace victorious
