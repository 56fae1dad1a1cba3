#include "victorious/track/scale_filter.h"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "victorious/track/cell_features.h"

namespace victorious {
namespace {

constexpr int kSizes = 17;
constexpr double kStep = 1.03;           // ratio of consecutive scales
constexpr double kSampleArea_px = 1024;  // area of a sample
constexpr double kSigma = 1.0;           // of the desired response, in steps
constexpr double kLeastDenominator = 1e-2;

double GrowthOf(double step) { return std::pow(kStep, step - kSizes / 2); }

}  // namespace

ScaleFilter::ScaleFilter(const TurnedBox& box) : sample_px_(WholeCells(box.width, box.height, kSampleArea_px)) {
  cv::Mat wanted(1, kSizes, CV_32F);
  for (int i = 0; i < kSizes; ++i) {
    const double steps = i - kSizes / 2;
    wanted.at<float>(i) = static_cast<float>(std::exp(-0.5 * steps * steps / (kSigma * kSigma)));
  }
  cv::dft(wanted, wanted_, cv::DFT_COMPLEX_OUTPUT);
}

cv::Mat ScaleFilter::Samples(const Levels& image, const TurnedBox& box) const {
  cv::Mat samples;
  for (int i = 0; i < kSizes; ++i) {
    const CellFeatures cells = GradientCells(CutOut(image, box.Scaled(GrowthOf(i)), sample_px_));
    cv::Mat column;
    for (const cv::Mat& channel : cells) column.push_back(channel.reshape(1, static_cast<int>(channel.total())));
    // A Hann window over the scales.
    const double taper = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 1) / (kSizes + 1));
    if (samples.empty()) samples.create(column.rows, kSizes, CV_32F);
    cv::Mat(column * taper).copyTo(samples.col(i));
  }
  cv::Mat spectra;
  cv::dft(samples, spectra, cv::DFT_COMPLEX_OUTPUT | cv::DFT_ROWS);
  return spectra;
}

void ScaleFilter::Learn(const Levels& image, const TurnedBox& box, double rate) {
  const cv::Mat x = Samples(image, box);
  cv::Mat numerator;
  cv::mulSpectrums(cv::repeat(wanted_, x.rows, 1), x, numerator, cv::DFT_ROWS, true);
  cv::Mat squares;
  cv::mulSpectrums(x, x, squares, cv::DFT_ROWS, true);
  cv::Mat energy;
  cv::extractChannel(squares, energy, 0);
  cv::Mat denominator;
  cv::reduce(energy, denominator, 0, cv::REDUCE_SUM);
  if (numerator_.empty()) {
    numerator_ = numerator;
    denominator_ = denominator;
    return;
  }
  // New matrices: copies of this filter share the old ones and must not change.
  numerator_ = numerator_ * (1 - rate) + numerator * rate;
  denominator_ = denominator_ * (1 - rate) + denominator * rate;
}

double ScaleFilter::Growth(const Levels& image, const TurnedBox& box) const {
  const cv::Mat x = Samples(image, box);
  cv::Mat products;
  cv::mulSpectrums(numerator_, x, products, cv::DFT_ROWS);
  cv::Mat sum;
  cv::reduce(products, sum, 0, cv::REDUCE_SUM);
  for (int i = 0; i < kSizes; ++i) {
    sum.at<cv::Vec2f>(i) /= denominator_.at<float>(i) + static_cast<float>(kLeastDenominator);
  }
  cv::Mat answer;
  cv::idft(sum, answer, cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
  cv::Point peak;
  cv::minMaxLoc(answer, nullptr, nullptr, nullptr, &peak);
  double step = peak.x;
  if (peak.x > 0 && peak.x < kSizes - 1) {
    const float before = answer.at<float>(peak.x - 1);
    const float here = answer.at<float>(peak.x);
    const float after = answer.at<float>(peak.x + 1);
    const float bend = before - 2 * here + after;
    if (bend < 0) step += 0.5 * (before - after) / bend;
  }
  return GrowthOf(step);
}

}  // namespace victorious
