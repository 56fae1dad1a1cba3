#include "experiments/view_grid.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr int kCellPx = 11;
constexpr int kTopPx = 24;

cv::Point CellOf(const ViewDirection& angles) {
  const auto step = [](double angle_rad) { return static_cast<int>(std::lround(DegreesFromRadians(angle_rad) / 10)); };
  return {(step(angles.azimuth_rad) % kViewColumns + kViewColumns) % kViewColumns, step(angles.off_nadir_rad)};
}

}  // namespace

cv::Mat MakeViewGrid(const ObjectModel& model, std::span<const double> values) {
  cv::Mat grid(kViewRows, kViewColumns, CV_32FC1, cv::Scalar(0));
  for (std::size_t view = 0; view < values.size(); ++view) {
    const cv::Point cell = CellOf(*model.views[view].angles);
    if (cell.y >= kViewRows) continue;
    const auto value = static_cast<float>(values[view]);
    if (cell.y == 0) {
      grid.row(0).setTo(value);
    } else {
      grid.at<float>(cell) = value;
    }
  }
  return grid;
}

cv::Mat DrawHeatMap(const cv::Mat& grid, const std::string& caption, const HighlightedViews& highlighted) {
  double most = 1;
  cv::minMaxLoc(grid, nullptr, &most);
  cv::Mat levels;
  grid.convertTo(levels, CV_8U, 255 / std::max(most, 1.0));
  cv::resize(levels, levels, {}, kCellPx, kCellPx, cv::INTER_NEAREST);
  cv::Mat colours;
  cv::applyColorMap(levels, colours, cv::COLORMAP_INFERNO);
  cv::Mat image(colours.rows + kTopPx, colours.cols, CV_8UC3, cv::Scalar::all(255));
  colours.copyTo(image(cv::Rect({0, kTopPx}, colours.size())));
  for (const ViewDirection& view : highlighted.views) {
    const cv::Point corner = CellOf(view) * kCellPx + cv::Point(0, kTopPx);
    cv::rectangle(image, cv::Rect(corner, cv::Size(kCellPx, kCellPx)), highlighted.colour);
  }
  DrawCaption(image, caption);
  return image;
}

void DrawCaption(cv::Mat& image, const std::string& text) {
  constexpr double kFont = 0.42;
  cv::putText(image, text, {6, 16}, cv::FONT_HERSHEY_SIMPLEX, kFont, cv::Scalar::all(0), 1, cv::LINE_AA);
}

}  // namespace victorious
