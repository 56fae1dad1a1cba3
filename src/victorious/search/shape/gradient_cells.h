// shape/, the feature of the shape search: histograms of gradient orientation in overlapping cells, normalised by the
// gradients around (Dalal and Triggs, CVPR 2005). Orientations are those of edges: the sign of the contrast, which
// depends on paint and background, does not count.
//
// With m the magnitude and a the orientation of the gradient at a pixel, 0 <= a < pi, and T a triangle of 8 px:
//   h_k = T * (m max(0, 1 - |8 a / pi - k|))           k = 0 to 7, circular
//   cell_k = min(0.9, sqrt(h_k / sqrt(G * sum_j h_j^2 + 4)))    G: Gaussian of 4 px
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious {

inline constexpr int kCellOrientations = 8;
inline constexpr int kCellSide_px = 4;  ///< between the cells of a template
inline constexpr int kCellStep_px = 2;  ///< between the cells of GradientCells
inline constexpr float kMaxCellValue = 0.9F;
inline constexpr int kMaxCellCode = 255;  ///< code of kMaxCellValue

/// Cells at every second pixel of an image: the cell (row, column) has its centre in the middle of pixel
/// (2 row, 2 column).
struct GradientCells {
  int rows = 0;
  int columns = 0;
  std::vector<std::uint8_t> codes;  ///< rows x columns x 8: cell values times 255 / 0.9

  [[nodiscard]] const std::uint8_t* at(int row, int column) const {
    return codes.data() + (static_cast<std::size_t>(row) * columns + column) * kCellOrientations;
  }
};

/// The codes of one cell: values are at most kMaxCellValue, and rounded.
[[nodiscard]] std::array<std::uint8_t, kCellOrientations> CodesOf(const std::array<float, kCellOrientations>& values);

/// @param grey  CV_8UC1, without impulse noise
/// Cost: about 3 ms for 320 x 240 pixels.
[[nodiscard]] GradientCells MakeGradientCells(const cv::Mat& grey);

}  // namespace victorious
