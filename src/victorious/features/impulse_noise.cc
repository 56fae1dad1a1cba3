#include "victorious/features/impulse_noise.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

constexpr int kStandsOut = 35;  // grey levels: below, codecs' ringing about an impulse would be taken for more of them
constexpr int kFarthest = 3;    // px to the pixels that replace an impulse

// 255 where there is an impulse.
cv::Mat ImpulsesOf(const cv::Mat& grey) {
  cv::Mat median;
  cv::Mat difference;
  cv::medianBlur(grey, median, 3);
  cv::absdiff(grey, median, difference);
  cv::Mat impulses = difference > kStandsOut;
  cv::medianBlur(grey, median, 5);
  cv::absdiff(grey, median, difference);
  impulses |= difference > 2 * kStandsOut;
  return impulses;
}

// The mean of the nearest clean pixels; the pixel itself where there is none within reach.
uchar Repaired(const cv::Mat& grey, const cv::Mat& impulses, int x, int y) {
  for (int reach = 1; reach <= kFarthest; ++reach) {
    float sum = 0;
    float weights = 0;
    for (int row = std::max(0, y - reach); row <= std::min(grey.rows - 1, y + reach); ++row) {
      for (int column = std::max(0, x - reach); column <= std::min(grey.cols - 1, x + reach); ++column) {
        if (impulses.at<uchar>(row, column) != 0) continue;
        const int distance2 = (row - y) * (row - y) + (column - x) * (column - x);
        const float weight = 1.0F / static_cast<float>(distance2);
        sum += weight * static_cast<float>(grey.at<uchar>(row, column));
        weights += weight;
      }
    }
    if (weights > 0) return cv::saturate_cast<uchar>(sum / weights);
  }
  return grey.at<uchar>(y, x);
}

}  // namespace

cv::Mat WithoutImpulses(const cv::Mat& grey, double least_share) {
  if (std::min(grey.rows, grey.cols) < 5) return grey;
  const cv::Mat impulses = ImpulsesOf(grey);
  if (cv::countNonZero(impulses) < least_share * static_cast<double>(impulses.total())) return grey;
  cv::Mat clean = grey.clone();
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      if (impulses.at<uchar>(y, x) != 0) clean.at<uchar>(y, x) = Repaired(grey, impulses, x, y);
    }
  }
  return clean;
}

}  // namespace victorious
