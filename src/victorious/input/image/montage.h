// Images side by side, and images that lines are drawn on: what the reports of experiments and `model show` draw.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious {

/// Returns a grey image as CV_8UC3, scaled, dimmed and posterised, so that lines stand out and the PNG file is small.
[[nodiscard]] cv::Mat PosteriseImage(const cv::Mat& grey, double scale);

/// Tiles images of one size, `columns` per row, in reading order.
[[nodiscard]] cv::Mat Montage(const std::vector<cv::Mat>& images, int columns);

}  // namespace victorious
