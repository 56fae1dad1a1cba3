#include "victorious/shape/gradient_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

constexpr double kSmoothing_px = 0.8;
constexpr double kNeighbourhood_px = 4.0;
constexpr float kNoise = 2.0F;  // grey levels: gradients of this size are not amplified
constexpr float kPi_f = 3.14159265F;
constexpr int kReach_px = 3;  // of the triangle
constexpr std::array<float, 2 * kReach_px + 1> kTriangle = {1 / 16.F, 2 / 16.F, 3 / 16.F, 4 / 16.F,
                                                            3 / 16.F, 2 / 16.F, 1 / 16.F};
constexpr int kKeptRows = 8;  // at least those of the triangle

int Mirrored(int at, int count) { return cv::borderInterpolate(at, count, cv::BORDER_REFLECT_101); }

// Rows of magnitudes, divided among the two nearest orientations and filtered along the row, at the columns of cells.
class OrientedRows {
 public:
  explicit OrientedRows(const cv::Mat& grey) : rows_(grey.rows), columns_((grey.cols + 1) / kCellStep_px) {
    grey.convertTo(smooth_, CV_32F);
    cv::GaussianBlur(smooth_, smooth_, {}, kSmoothing_px);
    x_.create(1, grey.cols, CV_32F);
    y_.create(1, grey.cols, CV_32F);
    oriented_.resize(static_cast<std::size_t>(grey.cols + 2 * kReach_px) * kCellOrientations);
    for (std::vector<float>& row : filtered_) row.resize(static_cast<std::size_t>(columns_) * kCellOrientations);
  }

  /// Each is valid for the next kKeptRows - 1 rows.
  const float* At(int row) {
    while (next_ <= row) MakeNext();
    return filtered_[static_cast<std::size_t>(row) % kKeptRows].data();
  }

 private:
  void MakeNext() {
    const int row = next_++;
    const auto* above = smooth_.ptr<float>(std::max(row - 1, 0));
    const auto* here = smooth_.ptr<float>(row);
    const auto* below = smooth_.ptr<float>(std::min(row + 1, rows_ - 1));
    const int columns = smooth_.cols;
    auto* const x = x_.ptr<float>();
    auto* const y = y_.ptr<float>();
    for (int column = 0; column < columns; ++column) y[column] = below[column] - above[column];
    for (int column = 1; column + 1 < columns; ++column) x[column] = here[column + 1] - here[column - 1];
    x[0] = here[std::min(1, columns - 1)] - here[0];
    x[columns - 1] = here[columns - 1] - here[std::max(0, columns - 2)];
    cv::cartToPolar(x_, y_, magnitude_, angle_);
    const auto* const magnitude = magnitude_.ptr<float>();
    const auto* const angle = angle_.ptr<float>();
    std::ranges::fill(oriented_, 0.0F);
    for (int column = 0; column < columns; ++column) {
      const float position = angle[column] * (kCellOrientations / kPi_f);
      const int lower = static_cast<int>(position);
      const float fraction = position - static_cast<float>(lower);
      float* const out = Oriented(column);
      out[lower % kCellOrientations] += magnitude[column] * (1 - fraction);
      out[(lower + 1) % kCellOrientations] += magnitude[column] * fraction;
    }
    for (int beside = 1; beside <= kReach_px; ++beside) {
      std::copy_n(Oriented(Mirrored(-beside, columns)), kCellOrientations, Oriented(-beside));
      std::copy_n(Oriented(Mirrored(columns - 1 + beside, columns)), kCellOrientations, Oriented(columns - 1 + beside));
    }
    float* const filtered = filtered_[static_cast<std::size_t>(row) % kKeptRows].data();
    for (int column = 0; column < columns_; ++column) {
      const float* const first = Oriented(kCellStep_px * column - kReach_px);
      std::array<float, kCellOrientations> sum{};
      for (std::size_t t = 0; t < kTriangle.size(); ++t) {
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += kTriangle[t] * first[t * kCellOrientations + k];
      }
      std::ranges::copy(sum, filtered + static_cast<std::ptrdiff_t>(column) * kCellOrientations);
    }
  }

  float* Oriented(int column) {
    return oriented_.data() + static_cast<std::ptrdiff_t>(column + kReach_px) * kCellOrientations;
  }

  cv::Mat smooth_;
  int rows_;
  int columns_;  // of cells
  int next_ = 0;
  cv::Mat x_;
  cv::Mat y_;
  cv::Mat magnitude_;
  cv::Mat angle_;
  std::vector<float> oriented_;  // one row, with what is mirrored beside it
  std::array<std::vector<float>, kKeptRows> filtered_;
};

}  // namespace

GradientCells MakeGradientCells(const cv::Mat& grey) {
  GradientCells cells{.rows = (grey.rows + 1) / kCellStep_px, .columns = (grey.cols + 1) / kCellStep_px, .codes = {}};
  const int values = cells.columns * kCellOrientations;  // of a row
  cv::Mat histogram = cv::Mat::zeros(cells.rows, values, CV_32F);
  cv::Mat energy = cv::Mat::zeros(cells.rows, cells.columns, CV_32F);
  OrientedRows oriented(grey);
  for (int row = 0; row < cells.rows; ++row) {
    auto* const sum = histogram.ptr<float>(row);
    for (int t = -kReach_px; t <= kReach_px; ++t) {
      const float* const other = oriented.At(Mirrored(kCellStep_px * row + t, grey.rows));
      const float weight = kTriangle[static_cast<std::size_t>(t + kReach_px)];
      for (int i = 0; i < values; ++i) sum[i] += weight * other[i];
    }
    auto* const squares = energy.ptr<float>(row);
    for (int i = 0; i < values; ++i) squares[i / kCellOrientations] += sum[i] * sum[i];
  }
  cv::GaussianBlur(energy, energy, {}, kNeighbourhood_px / kCellStep_px);
  for (int row = 0; row < cells.rows; ++row) {
    auto* const values_of_row = histogram.ptr<float>(row);
    const auto* const squares = energy.ptr<float>(row);
    for (int column = 0; column < cells.columns; ++column) {
      const float norm = 1 / std::sqrt(squares[column] + kNoise * kNoise);
      for (int k = 0; k < kCellOrientations; ++k) values_of_row[column * kCellOrientations + k] *= norm;
    }
  }
  cv::sqrt(histogram, histogram);
  cells.codes.resize(histogram.total());
  const cv::Mat codes(histogram.size(), CV_8U, cells.codes.data());
  histogram.convertTo(codes, CV_8U, kMaxCellCode / kMaxCellValue);  // saturated
  return cells;
}

}  // namespace victorious
