#include "victorious/input/image/pixel_grid.h"

#include <algorithm>
#include <array>
#include <string>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

const cv::Scalar kInk(0, 255, 255);
const cv::Scalar kPaper(0, 0, 0);

// Half transparent, so that what lies under a line stays visible.
void BlendLine(cv::Mat& bgr, const cv::Rect& line) {
  const cv::Rect inside = line & cv::Rect({0, 0}, bgr.size());
  if (inside.empty()) return;
  cv::Mat part = bgr(inside);
  cv::addWeighted(part, 0.5, cv::Mat(part.size(), part.type(), kInk), 0.5, 0, part);
}

// Text with its background, moved into the image.
void WriteLabel(cv::Mat& bgr, const std::string& text, cv::Point at, double scale) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline);
  at.x = std::clamp(at.x, 0, std::max(0, bgr.cols - size.width - 2));
  at.y = std::clamp(at.y, 0, std::max(0, bgr.rows - size.height - 3));
  cv::rectangle(bgr, cv::Rect(at, size + cv::Size(2, 3)), kPaper, cv::FILLED);
  cv::putText(bgr, text, at + cv::Point(1, size.height + 1), cv::FONT_HERSHEY_SIMPLEX, scale, kInk, 1, cv::LINE_AA);
}

}  // namespace

int PixelGridStep(int side_px) {
  constexpr int kMaxLines = 20;
  int step = 10;
  for (int decade = 10;; decade *= 10) {
    for (const int factor : std::array{1, 2, 5}) {
      step = decade * factor;
      if (side_px <= kMaxLines * step) return step;
    }
  }
}

void DrawPixelGrid(cv::Mat& bgr) {
  const int step = PixelGridStep(std::max(bgr.cols, bgr.rows));
  const int tick = step / 5;
  const int half_tick = std::max(1, step / 12);
  // Labels are legible at the size of a screen.
  const double scale = std::clamp(std::max(bgr.cols, bgr.rows) / 1900.0, 0.35, 1.4);
  for (int x = step; x < bgr.cols; x += step) BlendLine(bgr, {x, 0, 1, bgr.rows});
  for (int y = step; y < bgr.rows; y += step) BlendLine(bgr, {0, y, bgr.cols, 1});
  for (int y = 0; y < bgr.rows; y += step) {
    for (int x = tick; x < bgr.cols; x += tick) BlendLine(bgr, {x, y - half_tick, 1, 2 * half_tick + 1});
  }
  for (int x = 0; x < bgr.cols; x += step) {
    for (int y = tick; y < bgr.rows; y += tick) BlendLine(bgr, {x - half_tick, y, 2 * half_tick + 1, 1});
  }
  // Repeated every few lines, so that a label is near every object.
  constexpr int kRepeat = 5;
  for (int row = 0; row * step < bgr.rows; row += kRepeat) {
    for (int x = step; x < bgr.cols; x += step) WriteLabel(bgr, std::to_string(x), {x + 2, row * step + 2}, scale);
  }
  for (int column = 0; column * step < bgr.cols; column += kRepeat) {
    for (int y = step; y < bgr.rows; y += step) {
      const bool taken = column > 0 && y / step % kRepeat == 0;  // by the label of the vertical line
      if (!taken) WriteLabel(bgr, std::to_string(y), {column * step + 2, y + 2}, scale);
    }
  }
}

}  // namespace victorious
