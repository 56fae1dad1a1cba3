#include "victorious/shape/gradient_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

constexpr double kSmoothing_px = 0.8;
constexpr double kNeighbourhood_px = 4.0;
constexpr float kNoise = 2.0F;  // grey levels: gradients of this size are not amplified
constexpr float kPi_f = 3.14159265F;

// The gradient's magnitude, divided among the two nearest orientations.
std::array<cv::Mat, kCellOrientations> OrientedMagnitudes(const cv::Mat& grey) {
  cv::Mat smooth;
  grey.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {}, kSmoothing_px);
  std::array<cv::Mat, kCellOrientations> oriented;
  for (cv::Mat& channel : oriented) channel = cv::Mat::zeros(grey.size(), CV_32F);
  for (int row = 0; row < grey.rows; ++row) {
    const auto* above = smooth.ptr<float>(std::max(row - 1, 0));
    const auto* here = smooth.ptr<float>(row);
    const auto* below = smooth.ptr<float>(std::min(row + 1, grey.rows - 1));
    std::array<float*, kCellOrientations> out{};
    for (int k = 0; k < kCellOrientations; ++k)
      out[static_cast<std::size_t>(k)] = oriented[static_cast<std::size_t>(k)].ptr<float>(row);
    for (int column = 0; column < grey.cols; ++column) {
      const float x = here[std::min(column + 1, grey.cols - 1)] - here[std::max(column - 1, 0)];
      const float y = below[column] - above[column];
      const float magnitude = std::sqrt(x * x + y * y);
      if (magnitude == 0) continue;
      float position = std::atan2(y, x) * (kCellOrientations / kPi_f);
      if (position < 0) position += kCellOrientations;
      const float lower = std::floor(position);
      const auto first = static_cast<std::size_t>(lower) % kCellOrientations;
      const float fraction = position - lower;
      out[first][column] += magnitude * (1 - fraction);
      out[(first + 1) % kCellOrientations][column] += magnitude * fraction;
    }
  }
  return oriented;
}

}  // namespace

GradientCells MakeGradientCells(const cv::Mat& grey) {
  std::array<cv::Mat, kCellOrientations> histogram = OrientedMagnitudes(grey);
  const cv::Matx<float, 7, 1> triangle(1 / 16.F, 2 / 16.F, 3 / 16.F, 4 / 16.F, 3 / 16.F, 2 / 16.F, 1 / 16.F);
  cv::Mat energy = cv::Mat::zeros(grey.size(), CV_32F);
  for (cv::Mat& channel : histogram) {
    cv::sepFilter2D(channel, channel, CV_32F, triangle, triangle);
    energy += channel.mul(channel);
  }
  cv::GaussianBlur(energy, energy, {}, kNeighbourhood_px);
  GradientCells cells{.rows = (grey.rows + 1) / kCellStep_px, .columns = (grey.cols + 1) / kCellStep_px, .codes = {}};
  cells.codes.resize(static_cast<std::size_t>(cells.rows) * cells.columns * kCellOrientations);
  std::uint8_t* code = cells.codes.data();
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column) {
      const int y = kCellStep_px * row;
      const int x = kCellStep_px * column;
      const float norm = 1 / std::sqrt(energy.at<float>(y, x) + kNoise * kNoise);
      for (const cv::Mat& channel : histogram) {
        const float value = std::min(std::sqrt(std::max(channel.at<float>(y, x) * norm, 0.F)), kMaxCellValue);
        *code++ = static_cast<std::uint8_t>(std::lround(value * (kMaxCellCode / kMaxCellValue)));
      }
    }
  }
  return cells;
}

}  // namespace victorious
