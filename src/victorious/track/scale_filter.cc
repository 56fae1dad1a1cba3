#include "victorious/track/scale_filter.h"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "victorious/track/cell_features.h"

namespace victorious {
namespace {

constexpr int kScales = 17;
constexpr double kScaleStep = 1.03;      // ratio of consecutive scales
constexpr double kSampleArea_px = 1024;  // area of a sample
constexpr double kSigma = 1.0;           // of the desired response, in steps
constexpr double kMinDenominator = 1e-2;

double ScaleFactor(double step) { return std::pow(kScaleStep, step - kScales / 2); }

}  // namespace

ScaleFilter::ScaleFilter(const RotatedBox& box) : sample_px_(CellAlignedSize(box.width, box.height, kSampleArea_px)) {
  cv::Mat desired(1, kScales, CV_32F);
  for (int i = 0; i < kScales; ++i) {
    const double steps = i - kScales / 2;
    desired.at<float>(i) = static_cast<float>(std::exp(-0.5 * steps * steps / (kSigma * kSigma)));
  }
  cv::dft(desired, desired_spectrum_, cv::DFT_COMPLEX_OUTPUT);
}

cv::Mat ScaleFilter::ExtractSamples(const ImagePyramid& image, const RotatedBox& box) const {
  cv::Mat samples;
  for (int i = 0; i < kScales; ++i) {
    const CellFeatures cells = ComputeHogCells(CropRotated(image, box.Scaled(ScaleFactor(i)), sample_px_));
    cv::Mat column;
    for (const cv::Mat& channel : cells) column.push_back(channel.reshape(1, static_cast<int>(channel.total())));
    // A Hann window over the scales.
    const double taper = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 1) / (kScales + 1));
    if (samples.empty()) samples.create(column.rows, kScales, CV_32F);
    cv::Mat(column * taper).copyTo(samples.col(i));
  }
  cv::Mat spectra;
  cv::dft(samples, spectra, cv::DFT_COMPLEX_OUTPUT | cv::DFT_ROWS);
  return spectra;
}

void ScaleFilter::Update(const ImagePyramid& image, const RotatedBox& box, double rate) {
  const cv::Mat x = ExtractSamples(image, box);
  cv::Mat numerator;
  cv::mulSpectrums(cv::repeat(desired_spectrum_, x.rows, 1), x, numerator, cv::DFT_ROWS, true);
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

double ScaleFilter::EstimateScaleChange(const ImagePyramid& image, const RotatedBox& box) const {
  const cv::Mat x = ExtractSamples(image, box);
  cv::Mat products;
  cv::mulSpectrums(numerator_, x, products, cv::DFT_ROWS);
  cv::Mat sum;
  cv::reduce(products, sum, 0, cv::REDUCE_SUM);
  for (int i = 0; i < kScales; ++i) {
    sum.at<cv::Vec2f>(i) /= denominator_.at<float>(i) + static_cast<float>(kMinDenominator);
  }
  cv::Mat response;
  cv::idft(sum, response, cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
  cv::Point peak;
  cv::minMaxLoc(response, nullptr, nullptr, nullptr, &peak);
  double step = peak.x;
  if (peak.x > 0 && peak.x < kScales - 1) {
    const float before = response.at<float>(peak.x - 1);
    const float here = response.at<float>(peak.x);
    const float after = response.at<float>(peak.x + 1);
    const float curvature = before - 2 * here + after;
    if (curvature < 0) step += 0.5 * (before - after) / curvature;
  }
  return ScaleFactor(step);
}

}  // namespace victorious
