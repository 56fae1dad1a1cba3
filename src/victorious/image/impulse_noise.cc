#include "victorious/image/impulse_noise.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// Chosen on renderings with salt-and-pepper noise (`simulate`, compressed as video); not fitted.
constexpr int kMinDeviation = 35;  // grey levels above the median; lower values detect codec ringing around an impulse
constexpr int kMinWiderDeviation = 2 * kMinDeviation;  // above the 5 x 5 median, which detects pairs of impulses
constexpr int kMaxReach = 3;                           // px, radius of the pixels that replace an impulse
constexpr int kMaxSetNeighbours = 1;                   // an isolated pixel has at most so many among its eight
constexpr int kMaxFlatRange = 20;                      // grey levels, bound on the range of the 3 x 3 medians
constexpr double kMinFlatFraction = 0.02;  // minimum denominator, fraction of the image: robust to few flat pixels

// Mask: 255 at impulses.
// @param median  3 x 3 median of `grey`
cv::Mat DetectImpulses(const cv::Mat& grey, const cv::Mat& median) {
  cv::Mat difference;
  cv::absdiff(grey, median, difference);
  cv::Mat impulses = difference > kMinDeviation;
  cv::Mat wider;
  cv::medianBlur(grey, wider, 5);
  cv::absdiff(grey, wider, difference);
  impulses |= difference > kMinWiderDeviation;
  return impulses;
}

// Mask: keeps set pixels with at most one set pixel among the eight neighbours.
cv::Mat KeepIsolated(const cv::Mat& set) {
  cv::Mat count;
  cv::boxFilter(set / 255, count, CV_8U, {3, 3}, {-1, -1}, /*normalize=*/false, cv::BORDER_CONSTANT);
  return set & (count <= 1 + kMaxSetNeighbours);
}

// The fraction of impulses in flat regions: of salt among pixels dark enough for it, plus of pepper among pixels bright
// enough. In flat regions isolated outliers are noise; elsewhere also thin lines, leaves and print.
double ImpulseFraction(const cv::Mat& grey, const cv::Mat& median) {
  cv::Mat highest;
  cv::Mat lowest;
  cv::dilate(median, highest, {});
  cv::erode(median, lowest, {});
  const cv::Mat flat = highest - lowest < kMaxFlatRange;
  const auto impulse_fraction = [&](const cv::Mat& deviates, const cv::Mat& where) {
    const double least = kMinFlatFraction * static_cast<double>(grey.total());
    return cv::countNonZero(KeepIsolated(deviates) & where) / std::max<double>(cv::countNonZero(where), least);
  };
  cv::Mat above;
  cv::Mat below;
  cv::subtract(grey, median, above);  // saturates at 0
  cv::subtract(median, grey, below);
  return impulse_fraction(above > kMinDeviation, flat & (median < 255 - kMinDeviation)) +
         impulse_fraction(below > kMinDeviation, flat & (median > kMinDeviation));
}

// The pixels of the 3 x 3 around one, in the image.
cv::Rect Around(const cv::Point& pixel, const cv::Mat& image) {
  return cv::Rect(pixel.x - 1, pixel.y - 1, 3, 3) & cv::Rect({0, 0}, image.size());
}

// True if a pixel that deviates from the median counts as an impulse of ImpulseFraction.
bool IsFlatImpulse(const cv::Mat& grey, const cv::Mat& median, const cv::Point& pixel) {
  const int middle = median.at<uchar>(pixel);
  const bool above = grey.at<uchar>(pixel) > middle;
  if (above ? middle >= 255 - kMinDeviation : middle <= kMinDeviation) return false;
  int set = 0;
  int lowest = 255;
  int highest = 0;
  const cv::Rect around = Around(pixel, grey);
  for (int y = around.y; y < around.br().y; ++y) {
    for (int x = around.x; x < around.br().x; ++x) {
      const int other = median.at<uchar>(y, x);
      const int deviation = above ? grey.at<uchar>(y, x) - other : other - grey.at<uchar>(y, x);
      set += deviation > kMinDeviation ? 1 : 0;
      lowest = std::min(lowest, other);
      highest = std::max(highest, other);
    }
  }
  return set <= 1 + kMaxSetNeighbours && highest - lowest < kMaxFlatRange;
}

// True if there are too few impulses for ImpulseFraction to reach min_fraction: by its least denominators, at the few
// pixels that deviate, for a tenth of its cost. Of most frames without noise this is true.
bool HasFewImpulses(const cv::Mat& grey, const cv::Mat& median, double min_fraction) {
  constexpr double kRounding = 0.999;
  const double limit = kRounding * min_fraction * kMinFlatFraction * static_cast<double>(grey.total());
  cv::Mat difference;
  cv::absdiff(grey, median, difference);
  std::vector<cv::Point> deviating;
  cv::findNonZero(difference > kMinDeviation, deviating);
  int impulses = 0;
  for (const cv::Point& pixel : deviating) {
    if (impulses >= limit) return false;
    impulses += IsFlatImpulse(grey, median, pixel) ? 1 : 0;
  }
  return impulses < limit;
}

// The mean of the nearest clean pixels, weighted by 1 / distance^2; the pixel itself if none is within kMaxReach.
uchar InterpolatePixel(const cv::Mat& grey, const cv::Mat& impulses, int x, int y) {
  for (int reach = 1; reach <= kMaxReach; ++reach) {
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

cv::Mat RemoveImpulses(const cv::Mat& grey, double min_fraction) {
  if (std::min(grey.rows, grey.cols) < 5) return grey;
  cv::Mat median;
  cv::medianBlur(grey, median, 3);
  if (HasFewImpulses(grey, median, min_fraction) || ImpulseFraction(grey, median) < min_fraction) return grey;
  const cv::Mat impulses = DetectImpulses(grey, median);
  cv::Mat clean = grey.clone();
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      if (impulses.at<uchar>(y, x) != 0) clean.at<uchar>(y, x) = InterpolatePixel(grey, impulses, x, y);
    }
  }
  return clean;
}

}  // namespace victorious
