// track/, a picture as a grid of cells, each described by the directions of its gradients and by its colours: what the
// correlation filters see.
// Source: P. Felzenszwalb, R. Girshick, D. McAllester, D. Ramanan, "Object detection with discriminatively trained
// part-based models", PAMI 32(9), 2010: 18 signed and 9 unsigned directions, normalised by four blocks of cells and cut
// off at 0.2, and 4 sums that tell how much texture each block has. Beside them soft bins of colour: 5 of grey, 6 of
// hue.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious {

inline constexpr int kCell_px = 4;
inline constexpr int kGradientChannels = 31;
inline constexpr int kColourChannels = 11;

/// Rows and columns of cells, one matrix (CV_32F) a channel.
using CellFeatures = std::vector<cv::Mat>;

/// @param image  CV_8UC3 (BGR) or CV_8UC1; what is left of its sides after whole cells is not seen
/// @return kGradientChannels channels of (rows / kCell_px) x (columns / kCell_px)
CellFeatures GradientCells(const cv::Mat& image);

/// How much of each cell is of which colour: channels of 0 to 1 that add up to 1.
/// @param image  CV_8UC3 (BGR) or CV_8UC1
/// @return kColourChannels channels of (rows / kCell_px) x (columns / kCell_px)
CellFeatures ColourCells(const cv::Mat& image);

}  // namespace victorious
