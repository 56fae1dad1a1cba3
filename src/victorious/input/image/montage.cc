#include "victorious/input/image/montage.h"

#include <opencv2/imgproc.hpp>

namespace victorious {

cv::Mat PosteriseImage(const cv::Mat& grey, double scale) {
  constexpr double kStep = 24;
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  cv::medianBlur(small, small, 3);
  small.convertTo(small, CV_8U, 0.6 / kStep, 1.0);
  small.convertTo(small, CV_8U, kStep);
  cv::Mat bgr;
  cv::cvtColor(small, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

cv::Mat Montage(const std::vector<cv::Mat>& images, int columns) {
  constexpr int kGap = 4;
  const cv::Size tile = images.front().size() + cv::Size(kGap, kGap);
  const int rows = (static_cast<int>(images.size()) + columns - 1) / columns;
  cv::Mat montage(tile.height * rows - kGap, tile.width * columns - kGap, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < static_cast<int>(images.size()); ++i) {
    const cv::Mat& image = images[static_cast<std::size_t>(i)];
    image.copyTo(montage(cv::Rect({i % columns * tile.width, i / columns * tile.height}, image.size())));
  }
  return montage;
}

}  // namespace victorious
