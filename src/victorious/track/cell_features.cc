#include "victorious/track/cell_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

constexpr int kSignedBins = 18;   // orientations over the full circle
constexpr int kUnsignedBins = 9;  // orientations over the half circle
constexpr float kClip = 0.2F;     // upper bound of a normalised histogram value
constexpr int kGreyBins = 5;
constexpr int kHueBins = 6;

// The histogram of gradient magnitude by orientation of each cell: rows x (columns * kSignedBins). A pixel is
// distributed bilinearly over the four nearest cells.
cv::Mat OrientationHistograms(const cv::Mat& image, cv::Size cells) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::Mat x;
  cv::Mat y;
  cv::spatialGradient(grey, x, y);
  x.convertTo(x, CV_32F, 1.0 / 1020);
  y.convertTo(y, CV_32F, 1.0 / 1020);
  cv::Mat length;
  cv::Mat angle;
  cv::cartToPolar(x, y, length, angle);

  // With a margin of one cell on every side, removed at the end.
  const int stride = (cells.width + 2) * kSignedBins;
  cv::Mat sums = cv::Mat::zeros(cells.height + 2, stride, CV_32F);
  const int width = cells.width * kCell_px;
  const int height = cells.height * kCell_px;
  std::array<float, kCell_px> cell_weight;  // weight of the later cell, by the pixel's position in its cell
  std::array<int, kCell_px> step;           // offset of the earlier of the two nearest cells, in the padded grid
  for (int i = 0; i < kCell_px; ++i) {
    const float position = (static_cast<float>(i) + 0.5F) / kCell_px - 0.5F;  // from the cell's centre, in cells
    step[i] = position < 0 ? 0 : 1;
    cell_weight[i] = position < 0 ? position + 1 : position;
  }
  constexpr auto kBinsPerRad = static_cast<float>(kSignedBins / (2 * std::numbers::pi));
  for (int v = 0; v < height; ++v) {
    const auto* lengths = length.ptr<float>(v);
    const auto* angles = angle.ptr<float>(v);
    const float below = cell_weight[v % kCell_px];
    auto* upper = sums.ptr<float>(v / kCell_px + step[v % kCell_px]);
    auto* lower = sums.ptr<float>(v / kCell_px + step[v % kCell_px] + 1);
    for (int u = 0; u < width; ++u) {
      const float bins = angles[u] * kBinsPerRad;
      const auto first = static_cast<int>(bins);
      const float second_fraction = bins - static_cast<float>(first);
      const int bin = first % kSignedBins;
      const int next = (first + 1) % kSignedBins;
      const float right = cell_weight[u % kCell_px];
      const int left_cell = (u / kCell_px + step[u % kCell_px]) * kSignedBins;
      const float a = lengths[u] * (1 - second_fraction);
      const float b = lengths[u] * second_fraction;
      const float above = 1 - below;
      const float left = 1 - right;
      upper[left_cell + bin] += a * above * left;
      upper[left_cell + next] += b * above * left;
      upper[left_cell + kSignedBins + bin] += a * above * right;
      upper[left_cell + kSignedBins + next] += b * above * right;
      lower[left_cell + bin] += a * below * left;
      lower[left_cell + next] += b * below * left;
      lower[left_cell + kSignedBins + bin] += a * below * right;
      lower[left_cell + kSignedBins + next] += b * below * right;
    }
  }
  return sums(cv::Rect(kSignedBins, 1, cells.width * kSignedBins, cells.height));
}

// The squared norm of each cell's unsigned histogram, with a replicated margin of one cell.
cv::Mat GradientEnergy(const cv::Mat& sums, cv::Size cells) {
  cv::Mat energy(cells, CV_32F);
  for (int row = 0; row < cells.height; ++row) {
    const auto* of_row = sums.ptr<float>(row);
    for (int column = 0; column < cells.width; ++column) {
      float sum = 0;
      for (int k = 0; k < kUnsignedBins; ++k) {
        const float both = of_row[column * kSignedBins + k] + of_row[column * kSignedBins + k + kUnsignedBins];
        sum += both * both;
      }
      energy.at<float>(row, column) = sum;
    }
  }
  cv::copyMakeBorder(energy, energy, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  return energy;
}

cv::Size CellGridSize(const cv::Mat& image) { return {image.cols / kCell_px, image.rows / kCell_px}; }

}  // namespace

CellFeatures ComputeHogCells(const cv::Mat& image) {
  VICTORIOUS_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3);
  const cv::Size cells = CellGridSize(image);
  CellFeatures channels(kGradientChannels);
  for (cv::Mat& channel : channels) channel.create(cells, CV_32F);
  if (cells.area() == 0) return channels;
  const cv::Mat sums = OrientationHistograms(image, cells);
  cv::Mat energy = GradientEnergy(sums, cells);
  cv::Mat blocks;  // sums over 2 x 2 cells, stored at the lower right cell
  cv::boxFilter(energy, blocks, CV_32F, {2, 2}, {1, 1}, false, cv::BORDER_REPLICATE);
  constexpr float kMinEnergy = 1e-4F;  // limits the amplification of sensor noise in flat areas
  cv::Mat factors;
  cv::Mat roots;
  cv::sqrt(blocks + kMinEnergy, roots);
  cv::divide(1.0, roots, factors);

  std::array<float*, kGradientChannels> out;
  for (int row = 0; row < cells.height; ++row) {
    for (int k = 0; k < kGradientChannels; ++k) out[k] = channels[k].ptr<float>(row);
    const auto* of_row = sums.ptr<float>(row);
    const auto* upper = factors.ptr<float>(row + 1);
    const auto* lower = factors.ptr<float>(row + 2);
    for (int column = 0; column < cells.width; ++column) {
      const float* cell = of_row + static_cast<std::ptrdiff_t>(column) * kSignedBins;
      const std::array<float, 4> norms = {upper[column + 1], upper[column + 2], lower[column + 1], lower[column + 2]};
      std::array<float, 4> texture = {0, 0, 0, 0};
      for (int k = 0; k < kSignedBins; ++k) {
        float sum = 0;
        for (int n = 0; n < 4; ++n) {
          const float cut = std::min(cell[k] * norms[n], kClip);
          texture[n] += cut;
          sum += cut;
        }
        out[k][column] = 0.5F * sum;
      }
      for (int k = 0; k < kUnsignedBins; ++k) {
        const float both = cell[k] + cell[k + kUnsignedBins];
        float sum = 0;
        for (const float norm : norms) sum += std::min(both * norm, kClip);
        out[kSignedBins + k][column] = 0.5F * sum;
      }
      for (int n = 0; n < 4; ++n) out[kSignedBins + kUnsignedBins + n][column] = 0.2357F * texture[n];
    }
  }
  return channels;
}

CellFeatures ComputeColourCells(const cv::Mat& image) {
  VICTORIOUS_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3);
  const cv::Size cells = CellGridSize(image);
  CellFeatures channels;
  for (int k = 0; k < kColourChannels; ++k) channels.emplace_back(cv::Mat::zeros(cells, CV_32F));
  if (cells.area() == 0) return channels;
  // The mean colour of a cell suffices, at a sixteenth of the cost.
  cv::Mat mean;
  cv::resize(image(cv::Rect(0, 0, cells.width * kCell_px, cells.height * kCell_px)), mean, cells, 0, 0, cv::INTER_AREA);
  if (mean.channels() == 1) cv::cvtColor(mean, mean, cv::COLOR_GRAY2BGR);
  for (int row = 0; row < cells.height; ++row) {
    const auto* of_row = mean.ptr<cv::Vec3b>(row);
    for (int column = 0; column < cells.width; ++column) {
      const auto b = static_cast<float>(of_row[column][0]);
      const auto g = static_cast<float>(of_row[column][1]);
      const auto r = static_cast<float>(of_row[column][2]);
      const float max_channel = std::max({b, g, r});
      const float range = max_channel - std::min({b, g, r});
      // Saturation, 0 to 1; damped for dark pixels, whose hue is unreliable.
      const float saturation = std::min(1.0F, 2 * range / std::max(max_channel, 64.0F));
      const float grey = (0.114F * b + 0.587F * g + 0.299F * r) / 255.0F * (kGreyBins - 1);
      const int grey_bin = std::min(static_cast<int>(grey), kGreyBins - 2);
      const float grey_fraction = grey - static_cast<float>(grey_bin);
      channels[grey_bin].at<float>(row, column) = (1 - saturation) * (1 - grey_fraction);
      channels[grey_bin + 1].at<float>(row, column) = (1 - saturation) * grey_fraction;
      if (range <= 0) continue;
      float hue = 0;  // 0 to 6: red, yellow, green, cyan, blue, magenta
      if (max_channel == r)
        hue = (g - b) / range;
      else if (max_channel == g)
        hue = 2 + (b - r) / range;
      else
        hue = 4 + (r - g) / range;
      if (hue < 0) hue += kHueBins;
      const auto hue_bin = static_cast<int>(hue);
      const float hue_fraction = hue - static_cast<float>(hue_bin);
      channels[kGreyBins + hue_bin % kHueBins].at<float>(row, column) = saturation * (1 - hue_fraction);
      channels[kGreyBins + (hue_bin + 1) % kHueBins].at<float>(row, column) = saturation * hue_fraction;
    }
  }
  return channels;
}

}  // namespace victorious
