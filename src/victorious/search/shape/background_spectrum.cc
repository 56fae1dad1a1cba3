#include "victorious/search/shape/background_spectrum.h"

#include <cmath>

#include <Eigen/LU>
#include <opencv2/core.hpp>

#include "victorious/base/check.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Spectra = std::array<cv::Mat, kCellOrientations>;  // CV_32FC2

// Regularises the density: noise of this variance in each cell.
constexpr float kCellNoise = 0.02F;
constexpr int kStride = kCellSide_px / kCellStep_px;

// Of a spectrum: channels are real, so that the other columns follow from these, and the inverse transform reads no
// more.
int Columns(int side) { return side / 2 + 1; }

std::complex<float> At(const cv::Mat& spectrum, int row, int column) {
  const auto& value = spectrum.at<cv::Vec2f>(row, column);
  return {value[0], value[1]};
}

Spectra Transform(const std::array<cv::Mat, kCellOrientations>& channels) {
  Spectra spectra;
  for (std::size_t k = 0; k < channels.size(); ++k) cv::dft(channels[k], spectra[k], cv::DFT_COMPLEX_OUTPUT);
  return spectra;
}

// A smooth window of unit mean square: without it, the border of a part of the background would count as an edge.
cv::Mat HannWindow(int side) {
  cv::Mat window(side, side, CV_32F);
  const auto along = [&](int i) { return 0.5 - 0.5 * std::cos(2 * kPi * (i + 1) / (side + 1)); };
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      window.at<float>(row, column) = static_cast<float>(along(row) * along(column));
    }
  }
  window /= cv::norm(window) / side;
  return window;
}

std::array<float, kCellOrientations> MeanOf(std::span<const GradientCells> frames) {
  std::array<double, kCellOrientations> sum{};
  double count = 0;
  for (const GradientCells& frame : frames) {
    for (std::size_t i = 0; i < frame.codes.size(); ++i) sum[i % kCellOrientations] += frame.codes[i];
    count += static_cast<double>(frame.codes.size()) / kCellOrientations;
  }
  std::array<float, kCellOrientations> mean{};
  for (std::size_t k = 0; k < mean.size(); ++k) {
    mean[k] = static_cast<float>(count > 0 ? sum[k] / count * kMaxCellValue / kMaxCellCode : 0.0);
  }
  return mean;
}

}  // namespace

BackgroundSpectrum::BackgroundSpectrum(std::span<const GradientCells> frames, int side)
    : side_(side), mean_(MeanOf(frames)) {
  VICTORIOUS_CHECK(side > 0 && side % 2 == 0);
  const cv::Mat window = HannWindow(side);
  const int columns = Columns(side);
  const auto frequencies = static_cast<std::size_t>(side) * columns;
  std::vector<Density> density(frequencies, Density::Zero());
  int windows = 0;
  std::array<cv::Mat, kCellOrientations> part;
  for (cv::Mat& channel : part) channel.create(side, side, CV_32F);
  for (const GradientCells& frame : frames) {
    for (int top = 0; top + kStride * (side - 1) < frame.rows; top += kStride * side / 2) {
      for (int left = 0; left + kStride * (side - 1) < frame.columns; left += kStride * side / 2) {
        for (int row = 0; row < side; ++row) {
          for (int column = 0; column < side; ++column) {
            const std::uint8_t* const cell = frame.at(top + kStride * row, left + kStride * column);
            for (std::size_t k = 0; k < part.size(); ++k) {
              part[k].at<float>(row, column) =
                  (static_cast<float>(cell[k]) * (kMaxCellValue / kMaxCellCode) - mean_[k]) *
                  window.at<float>(row, column) / static_cast<float>(side);
            }
          }
        }
        const Spectra spectra = Transform(part);
        ++windows;
        for (int row = 0; row < side; ++row) {
          for (int column = 0; column < columns; ++column) {
            Eigen::Vector<std::complex<float>, kCellOrientations> here;
            for (int k = 0; k < kCellOrientations; ++k) {
              here[k] = At(spectra[static_cast<std::size_t>(k)], row, column);
            }
            density[static_cast<std::size_t>(row) * columns + column] += here * here.adjoint();
          }
        }
      }
    }
  }
  inverse_.reserve(frequencies);
  for (Density& one : density) {
    if (windows > 0) one /= static_cast<float>(windows);
    one += (windows > 0 ? kCellNoise : 1.0F) * Density::Identity();
    inverse_.push_back(one.inverse());
  }
}

CellTemplate BackgroundSpectrum::Whiten(const CellTemplate& cells) const {
  VICTORIOUS_CHECK(cells.rows <= side_ && cells.columns <= side_);
  const int top = side_ / 2 - cells.rows / 2;
  const int left = side_ / 2 - cells.columns / 2;
  std::array<cv::Mat, kCellOrientations> channels;
  for (int k = 0; k < kCellOrientations; ++k) {
    cv::Mat& channel = channels[static_cast<std::size_t>(k)];
    channel = cv::Mat::zeros(side_, side_, CV_32F);
    for (int row = 0; row < cells.rows; ++row) {
      auto* const out = channel.ptr<float>(top + row) + left;
      for (int column = 0; column < cells.columns; ++column) out[column] = cells.at(row, column, k);
    }
  }
  Spectra spectra = Transform(channels);
  const int columns = Columns(side_);
  for (int row = 0; row < side_; ++row) {
    std::array<cv::Vec2f*, kCellOrientations> of_row{};
    for (std::size_t k = 0; k < of_row.size(); ++k) of_row[k] = spectra[k].ptr<cv::Vec2f>(row);
    for (int column = 0; column < columns; ++column) {
      Eigen::Vector<std::complex<float>, kCellOrientations> here;
      for (std::size_t k = 0; k < of_row.size(); ++k) {
        here[static_cast<int>(k)] = {of_row[k][column][0], of_row[k][column][1]};
      }
      here = (inverse_[static_cast<std::size_t>(row) * columns + column] * here).eval();
      for (std::size_t k = 0; k < of_row.size(); ++k) {
        of_row[k][column] = {here[static_cast<int>(k)].real(), here[static_cast<int>(k)].imag()};
      }
    }
  }
  CellTemplate weights{.rows = cells.rows, .columns = cells.columns, .values = std::vector<float>(cells.values.size())};
  double squared_norm = 0;
  for (int k = 0; k < kCellOrientations; ++k) {
    cv::Mat channel;
    cv::dft(spectra[static_cast<std::size_t>(k)], channel, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
    for (int row = 0; row < cells.rows; ++row) {
      const auto* const in = channel.ptr<float>(top + row) + left;
      for (int column = 0; column < cells.columns; ++column) {
        weights.at(row, column, k) = in[column];
        squared_norm += static_cast<double>(in[column]) * cells.at(row, column, k);
      }
    }
  }
  const float norm = squared_norm > 0 ? static_cast<float>(1 / std::sqrt(squared_norm)) : 0.0F;
  for (float& value : weights.values) value *= norm;
  return weights;
}

}  // namespace victorious
