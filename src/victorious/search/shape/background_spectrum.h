// shape/, the statistics of what is not the object: mean and spectral density of gradient cells over the frames of a
// video. With them a template becomes the linear discriminant between the object and the background (Hariharan, Malik
// and Ramanan, ECCV 2012): edges that are common, or that follow from their neighbours, count less.
//
// The background is taken as stationary. With V(f) the Fourier transform of a template's eight channels, less their
// mean, and S(f) the 8 x 8 spectral density of the background, the weights are
//   W(f) = S(f)^-1 V(f) / n,    n^2 = sum over f of V(f)* S(f)^-1 V(f)
// so that the weighted sum over a window of background has mean 0 and, were the template not truncated, variance 1.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/search/shape/gradient_cells.h"

namespace victorious {

/// Template cells, channels last: rows x columns x 8 values.
struct CellTemplate {
  int rows = 0;
  int columns = 0;
  std::vector<float> values;

  [[nodiscard]] float& at(int row, int column, int channel) {
    return values[(static_cast<std::size_t>(row) * columns + column) * kCellOrientations + channel];
  }
  [[nodiscard]] float at(int row, int column, int channel) const {
    return values[(static_cast<std::size_t>(row) * columns + column) * kCellOrientations + channel];
  }
};

class BackgroundSpectrum {
 public:
  /// @param frames  images of the background at several scales
  /// @param side    of the templates, cells; even
  /// With fewer than one window of side x side cells in all frames, the background is white.
  BackgroundSpectrum(std::span<const GradientCells> frames, int side);

  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] const std::array<float, kCellOrientations>& mean() const { return mean_; }

  /// The weights W of a template's cells, from which the mean was subtracted; weights beyond them are left out.
  /// @param cells  at most side() x side(): their middle, row (rows / 2) and column (columns / 2), is that of the
  /// spectrum Cost: about 0.2 ms for 24 x 24 cells.
  [[nodiscard]] CellTemplate Whiten(const CellTemplate& cells) const;

 private:
  using Density = Eigen::Matrix<std::complex<float>, kCellOrientations, kCellOrientations>;

  int side_;
  std::array<float, kCellOrientations> mean_{};
  std::vector<Density> inverse_;  // S(f)^-1, row-major: side rows of side / 2 + 1 frequencies
};

}  // namespace victorious
