#include "victorious/search/shape/gradient_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/kernels/gradient_rows.h"

namespace victorious {
namespace {

constexpr double kSmoothing_px = 0.8;
constexpr double kNeighbourhood_px = 4.0;
constexpr float kNoise = 2.0F;  // grey levels: gradients of this size are not amplified
using kernels::kGradientMargin;
using kernels::kGradientPadding;
using kernels::kTriangleReach;
using kernels::kTriangleTaps;
constexpr int kReach_px = static_cast<int>(kTriangleReach);
constexpr std::size_t kKeptRows = 8;  // at least those of the triangle
static_assert(kernels::kGradientBins == kCellOrientations && kKeptRows >= kTriangleTaps && kCellStep_px == 2);

int Mirrored(int at, int count) { return cv::borderInterpolate(at, count, cv::BORDER_REFLECT_101); }

// Rows of gradients divided among orientations and filtered along the row, at the columns of cells: one part of
// `stride` elements for each orientation.
class OrientedRows {
 public:
  explicit OrientedRows(const cv::Mat& grey)
      : width_(static_cast<std::size_t>(grey.cols)),
        columns_((width_ + 1) / kCellStep_px),
        stride_(columns_ + kGradientPadding),
        oriented_stride_(kGradientMargin + width_ + kGradientPadding),
        oriented_(kCellOrientations * oriented_stride_) {
    cv::Mat smooth;
    grey.convertTo(smooth, CV_32F);
    cv::GaussianBlur(smooth, smooth, {}, kSmoothing_px);
    constexpr int kPadding = kGradientPadding;
    cv::copyMakeBorder(smooth, padded_, 0, 0, 1, kPadding, cv::BORDER_REPLICATE);
    for (std::vector<float>& row : filtered_) row.resize(kCellOrientations * stride_);
  }

  /// Elements from orientation to orientation of a row.
  [[nodiscard]] std::size_t stride() const { return stride_; }

  /// Each is valid for the next kKeptRows - 1 rows.
  const float* At(int row) {
    while (next_ <= row) MakeNext();
    return filtered_[static_cast<std::size_t>(row) % kKeptRows].data();
  }

 private:
  void MakeNext() {
    const int row = next_++;
    const float* const above = padded_.ptr<float>(std::max(row - 1, 0)) + 1;
    const float* const below = padded_.ptr<float>(std::min(row + 1, padded_.rows - 1)) + 1;
    kernels::OrientGradients(above, padded_.ptr<float>(row) + 1, below, width_, oriented_stride_,
                             oriented_.data() + kGradientMargin);
    float* const filtered = filtered_[static_cast<std::size_t>(row) % kKeptRows].data();
    const int count = static_cast<int>(width_);
    // In this order: what is written after a row lies within its padding.
    for (std::size_t k = 0; k < kCellOrientations; ++k) {
      float* const line = oriented_.data() + k * oriented_stride_ + kGradientMargin;
      for (int beside = 1; beside <= kReach_px; ++beside) {
        line[-beside] = line[Mirrored(-beside, count)];
        line[count - 1 + beside] = line[Mirrored(count - 1 + beside, count)];
      }
      kernels::ReduceGradients(line, columns_, filtered + k * stride_);
    }
  }

  std::size_t width_;
  std::size_t columns_;  // of cells
  std::size_t stride_;
  std::size_t oriented_stride_;
  cv::Mat padded_;
  int next_ = 0;
  std::vector<float> oriented_;  // one row
  std::array<std::vector<float>, kKeptRows> filtered_;
};

}  // namespace

std::array<std::uint8_t, kCellOrientations> CodesOf(const std::array<float, kCellOrientations>& values) {
  std::array<std::uint8_t, kCellOrientations> codes{};
  for (std::size_t k = 0; k < codes.size(); ++k) {
    codes[k] =
        static_cast<std::uint8_t>(std::lround(std::min(values[k], kMaxCellValue) * (kMaxCellCode / kMaxCellValue)));
  }
  return codes;
}

GradientCells MakeGradientCells(const cv::Mat& grey) {
  GradientCells cells{.rows = (grey.rows + 1) / kCellStep_px, .columns = (grey.cols + 1) / kCellStep_px, .codes = {}};
  const auto columns = static_cast<std::size_t>(cells.columns);
  OrientedRows oriented(grey);
  const std::size_t stride = oriented.stride();
  const std::size_t row_values = kCellOrientations * stride;
  std::vector<float> histogram(static_cast<std::size_t>(cells.rows) * row_values + kGradientPadding);
  cv::Mat energy = cv::Mat::zeros(cells.rows, cells.columns, CV_32F);
  for (int row = 0; row < cells.rows; ++row) {
    std::array<const float*, kTriangleTaps> rows{};
    for (int t = -kReach_px; t <= kReach_px; ++t) {
      rows[static_cast<std::size_t>(t + kReach_px)] = oriented.At(Mirrored(kCellStep_px * row + t, grey.rows));
    }
    float* const sums = histogram.data() + static_cast<std::size_t>(row) * row_values;
    auto* const squares = energy.ptr<float>(row);
    for (std::size_t k = 0; k < kCellOrientations; ++k) {
      std::array<const float*, kTriangleTaps> of_bin = rows;
      for (const float*& values : of_bin) values += k * stride;
      float* const sum = sums + k * stride;
      kernels::SumGradientRows(of_bin, columns, sum);
      for (std::size_t c = 0; c < columns; ++c) squares[c] += sum[c] * sum[c];
    }
  }
  cv::GaussianBlur(energy, energy, {}, kNeighbourhood_px / kCellStep_px);
  cells.codes.resize(static_cast<std::size_t>(cells.rows) * columns * kCellOrientations);
  std::vector<float> of_row(columns + kGradientPadding);
  std::vector<std::uint8_t> codes(kCellOrientations * of_row.size());
  for (int row = 0; row < cells.rows; ++row) {
    std::copy_n(energy.ptr<float>(row), columns, of_row.begin());
    const std::size_t at = static_cast<std::size_t>(row);
    kernels::EncodeGradients(histogram.data() + at * row_values, stride, of_row.data(), columns, kNoise * kNoise,
                             kMaxCellCode / kMaxCellValue, codes.data());
    std::copy_n(codes.begin(), kCellOrientations * columns, cells.codes.begin() + at * columns * kCellOrientations);
  }
  return cells;
}

}  // namespace victorious
