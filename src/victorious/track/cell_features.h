// track/: dense HOG and colour features on a grid of cells: the input of the correlation filters.
// Source: P. Felzenszwalb, R. Girshick, D. McAllester, D. Ramanan, "Object detection with discriminatively trained
// part-based models", PAMI 32(9), 2010. 31 gradient channels: 18 signed and 9 unsigned orientations, normalised by four
// blocks of cells and clipped at 0.2, and 4 texture sums, one per block. 11 colour channels: soft histograms of 5 grey
// and 6 hue bins.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious {

inline constexpr int kCell_px = 4;
inline constexpr int kGradientChannels = 31;
inline constexpr int kColourChannels = 11;

/// One CV_32F matrix per channel, of cell rows x cell columns.
using CellFeatures = std::vector<cv::Mat>;

/// HOG features.
/// @param image  CV_8UC3 (BGR) or CV_8UC1; pixels beyond the last whole cell are ignored
/// @return kGradientChannels channels of (rows / kCell_px) x (columns / kCell_px)
CellFeatures ComputeHogCells(const cv::Mat& image);

/// The colour histogram of each cell: channels in [0, 1] that sum to 1.
/// @param image  CV_8UC3 (BGR) or CV_8UC1
/// @return kColourChannels channels of (rows / kCell_px) x (columns / kCell_px)
CellFeatures ComputeColourCells(const cv::Mat& image);

}  // namespace victorious
