// A rendering laid over a picture, at any size and turn.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/similarity.h"

namespace victorious {

/// @param grey               CV_8UC1
/// @param mask               CV_8UC1, of its size: how much of a pixel is object, 0 to 255; the rest is left out
/// @param picture_from_grey  px; where it shrinks, pixels are averaged
/// @param picture            CV_8UC1; what falls outside is left out
void Paste(const cv::Mat& grey, const cv::Mat& mask, const Similarity2& picture_from_grey, cv::Mat& picture);

}  // namespace victorious
