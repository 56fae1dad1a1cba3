// The sphere of a CAD model's views as a grid: azimuth to the right from 0, the off-nadir angle downwards from 0 to 70
// degrees, a cell each 10 degrees.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/types/object_model.h"

namespace victorious {

inline constexpr int kViewColumns = 36;
inline constexpr int kViewRows = 8;

/// CV_32FC1: a value for each view of the model; the pole's fills its row.
[[nodiscard]] cv::Mat GridOfViews(const ObjectModel& model, std::span<const double> values);

/// Cells to be framed in a picture of a grid.
struct FramedViews {
  std::vector<ViewAngles> views;
  cv::Scalar colour;
};

/// CV_8UC3, with the caption above. The largest value, or 1 if that is more, is brightest.
[[nodiscard]] cv::Mat HeatMapOf(const cv::Mat& grid, const std::string& caption, const FramedViews& framed);

/// Writes dark letters into the left upper corner.
void Caption(cv::Mat& picture, const std::string& text);

}  // namespace victorious
