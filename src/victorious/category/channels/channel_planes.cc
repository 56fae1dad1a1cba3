#include "victorious/category/channels/channel_planes.h"

#include <algorithm>
#include <array>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "victorious/kernels/channel_rows.h"
#include "victorious/kernels/gradient_rows.h"
#include "victorious/kernels/window_trees.h"

namespace victorious {
namespace {

constexpr int kMeanReach = 3;         // cells to each side over which gradients are averaged
constexpr float kGradientNoise = 32;  // of a cell: the sum over 4 px of differences of pixels two apart
constexpr float kGradientGain = 56;   // a byte holds up to 4.5 times the mean
constexpr int kBandRows = 24;

// The gradients of some rows of cells: planes of floats, 8 orientations and their sum.
class GradientBand {
 public:
  // Of the rows first to last - 1, which may lie outside the image: these are 0.
  GradientBand(const cv::Mat& luma, int columns, int first, int last)
      : columns_(static_cast<std::size_t>(columns)),
        first_(first),
        rows_(static_cast<std::size_t>(last - first)),
        sums_(kPlanes * rows_ * columns_) {
    const auto width = static_cast<std::size_t>(columns) * kBaseCell_px;
    const std::size_t stride = width + kernels::kGradientPadding;
    std::array<std::vector<float>, 3> around;
    for (auto& row : around) row.resize(1 + stride + kernels::kGradientPadding);
    std::vector<float> bins(kernels::kGradientBins * stride + kernels::kGradientPadding);
    const auto read = [&](int y, std::vector<float>& to) {
      const auto* from = luma.ptr<std::uint8_t>(std::clamp(y, 0, luma.rows - 1));
      to[0] = from[0];
      for (std::size_t x = 0; x < width; ++x) to[1 + x] = from[x];
      to[1 + width] = from[std::min(static_cast<int>(width), luma.cols - 1)];
    };
    const int inside_first = std::max(first, 0);
    const int inside_last = std::min(last, luma.rows / kBaseCell_px);
    for (int y = inside_first * kBaseCell_px; y < inside_last * kBaseCell_px; ++y) {
      for (int k = -1; k <= 1; ++k) read(y + k, around[static_cast<std::size_t>(k + 1)]);
      kernels::OrientGradients(around[0].data() + 1, around[1].data() + 1, around[2].data() + 1, width, stride,
                               bins.data());
      for (std::size_t k = 0; k < kernels::kGradientBins; ++k) {
        const float* const from = bins.data() + k * stride;
        kernels::AddPixelPairs(from, columns_, Row(k, y / kBaseCell_px));
      }
    }
    for (std::size_t k = 0; k < kernels::kGradientBins; ++k) {
      const float* const from = sums_.data() + k * rows_ * columns_;
      float* const to = sums_.data() + kernels::kGradientBins * rows_ * columns_;
      for (std::size_t i = 0; i < rows_ * columns_; ++i) to[i] += from[i];
    }
  }

  // Of an orientation, or of all: kernels::kGradientBins.
  float* Row(std::size_t plane, int y) {
    return sums_.data() + (plane * rows_ + static_cast<std::size_t>(y - first_)) * columns_;
  }

 private:
  static constexpr std::size_t kPlanes = kernels::kGradientBins + 1;

  std::size_t columns_;
  int first_;
  std::size_t rows_;
  std::vector<float> sums_;
};

// The mean of the magnitude around each cell of row y; cells outside the image count as 0.
void AverageMagnitude(GradientBand& band, int y, int columns, std::vector<float>& column_sums,
                      std::vector<float>& mean) {
  const auto count = static_cast<std::size_t>(columns);
  column_sums.assign(count + 2 * kMeanReach, 0.0F);
  for (int k = -kMeanReach; k <= kMeanReach; ++k) {
    const float* const row = band.Row(kernels::kGradientBins, y + k);
    for (std::size_t c = 0; c < count; ++c) column_sums[kMeanReach + c] += row[c];
  }
  constexpr int kSide = 2 * kMeanReach + 1;
  mean.assign(count, 0.0F);
  for (std::size_t k = 0; k < kSide; ++k) {
    for (std::size_t c = 0; c < count; ++c) mean[c] += column_sums[c + k];
  }
  for (float& value : mean) value *= 1.0F / (kSide * kSide);
}

}  // namespace

void ChannelPlanes::Resize(int new_columns, int new_rows) {
  columns = new_columns;
  rows = new_rows;
  stride = new_columns;
  bytes.resize(static_cast<std::size_t>(kChannelCount * plane()) + kernels::kWindowPadding);
}

cv::Mat ChannelPlanes::Plane(int channel) {
  return {rows, columns, CV_8UC1, bytes.data() + channel * plane(), static_cast<std::size_t>(stride)};
}

cv::Mat ChannelPlanes::Plane(int channel) const {
  // OpenCV has no image of constant bytes; it is only read.
  return const_cast<ChannelPlanes*>(this)->Plane(channel);
}

cv::Mat LumaAndChroma(const cv::Mat& image) {
  cv::Mat colour = image;
  if (image.channels() == 1) cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  cv::Mat converted;
  cv::cvtColor(colour, converted, cv::COLOR_BGR2YCrCb);
  return converted;
}

cv::Mat HalveImage(const cv::Mat& image) {
  const cv::Size half(image.cols / kBaseCell_px, image.rows / kBaseCell_px);
  cv::Mat halved;
  cv::resize(image({0, 0, half.width * kBaseCell_px, half.height * kBaseCell_px}), halved, half, 0, 0, cv::INTER_AREA);
  return halved;
}

ChannelPlanes ComputeChannels(const cv::Mat& image, const cv::Mat& half) {
  ChannelPlanes base;
  base.Resize(half.cols, half.rows);
  cv::Mat luma;
  cv::extractChannel(image, luma, 0);
  std::vector<cv::Mat> colours = {base.Plane(0), base.Plane(1), base.Plane(2)};
  cv::split(half, colours);
  const int bands = (base.rows + kBandRows - 1) / kBandRows;
  oneapi::tbb::parallel_for(0, bands, [&](int b) {
    const int first = b * kBandRows;
    const int last = std::min(base.rows, first + kBandRows);
    GradientBand band(luma, base.columns, first - kMeanReach, last + kMeanReach);
    std::vector<float> column_sums;
    std::vector<float> gain;
    for (int y = first; y < last; ++y) {
      AverageMagnitude(band, y, base.columns, column_sums, gain);
      for (float& value : gain) value = kGradientGain / (value + kGradientNoise);
      const auto encode = [&](std::size_t plane, int channel) {
        kernels::EncodeCells(band.Row(plane, y), gain.data(), gain.size(),
                             base.bytes.data() + base.OffsetOf(channel, 0, y));
      };
      encode(kernels::kGradientBins, kFirstOrientation - 1);
      for (int k = 0; k < kOrientationChannels; ++k) encode(static_cast<std::size_t>(k), kFirstOrientation + k);
    }
  });
  return base;
}

void ResampleChannels(const ChannelPlanes& base, int columns, int rows, int border, ChannelPlanes& level) {
  level.Resize(columns + 2 * border, rows + 2 * border);
  oneapi::tbb::parallel_for(0, kChannelCount, [&](int channel) {
    cv::Mat to = level.Plane(channel);
    cv::Mat inside = to({border, border, columns, rows});
    cv::resize(base.Plane(channel), inside, inside.size(), 0, 0, cv::INTER_LINEAR);
    for (int y = 0; y < rows; ++y) {
      auto* const row = to.ptr<std::uint8_t>(y + border);
      std::fill_n(row, border, row[border]);
      std::fill_n(row + border + columns, border, row[border + columns - 1]);
    }
    for (int y = 0; y < border; ++y) {
      to.row(border).copyTo(to.row(y));
      to.row(border + rows - 1).copyTo(to.row(border + rows + y));
    }
  });
}

}  // namespace victorious
