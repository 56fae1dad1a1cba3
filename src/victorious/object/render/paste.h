// Composites a grey rendering into an image under a similarity transform.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/similarity.h"

namespace victorious {

/// Blends `grey` over `image` by the coverage in `mask`.
/// @param grey             CV_8UC1, the rendering
/// @param mask             CV_8UC1, same size as `grey`: coverage of each pixel by the object, 0 to 255
/// @param image_from_grey  px; a scale below 1 applies a Gaussian low-pass filter first (anti-aliasing)
/// @param image            CV_8UC1, changed in place; parts of the rendering outside it are clipped
void Paste(const cv::Mat& grey, const cv::Mat& mask, const Similarity2& image_from_grey, cv::Mat& image);

}  // namespace victorious
