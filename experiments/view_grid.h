// Draws values over the view sphere of a CAD model as a grid: azimuth from 0 to the right, off-nadir angle from 0 to 70
// degrees downwards, one cell per 10 degrees.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/types/object_model.h"

namespace victorious {

inline constexpr int kViewColumns = 36;
inline constexpr int kViewRows = 8;

/// Returns the grid, CV_32FC1, kViewRows x kViewColumns. The value of the pole fills its row.
/// @param values  one per view of the model; every view has angles
[[nodiscard]] cv::Mat MakeViewGrid(const ObjectModel& model, std::span<const double> values);

/// Cells to highlight by a frame.
struct HighlightedViews {
  std::vector<ViewDirection> views;
  cv::Scalar colour;
};

/// Returns the heat map, CV_8UC3, with the caption above it. The maximum of the values and 1 is the brightest colour.
[[nodiscard]] cv::Mat DrawHeatMap(const cv::Mat& grid, const std::string& caption, const HighlightedViews& highlighted);

/// Writes a caption in black into the upper left corner.
void DrawCaption(cv::Mat& image, const std::string& text);

}  // namespace victorious
