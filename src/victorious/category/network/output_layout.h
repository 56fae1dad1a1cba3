// Recognises what the outputs of a detection network mean from their shapes, the number of classes and the size of its
// input. Networks of different families differ in the number of candidates: a YOLOX has one in each cell of its grids
// of strides 8, 16 and 32, a YOLOv5 three.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/base/error.h"
#include "victorious/category/network/detector_settings.h"

namespace victorious {

/// A class list of more names is refused.
inline constexpr std::size_t kMaxDetectorClasses = 10'000;

/// A grid of cells over the input of a network.
struct CellGrid {
  int stride = 0;  ///< px of the input
  int columns = 0;
  int rows = 0;

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// The grids of successive strides, from 8 (or 4) on, that have this many cells in all; empty if none have.
[[nodiscard]] std::vector<CellGrid> GridsOf(std::size_t cells, cv::Size input);

/// The bins of a distribution of one side in the outputs of a NanoDet; 0 if they are none of its.
/// @param shapes  of the outputs
[[nodiscard]] int NanodetBins(std::span<const std::vector<int>> shapes, std::size_t classes, cv::Size input);

/// True if the outputs may be of this layout.
/// @param exact  the number of candidates must be that of the layout's grids, too
[[nodiscard]] bool FitsLayout(DetectorLayout layout, std::span<const std::vector<int>> shapes, std::size_t classes,
                              cv::Size input, bool exact);

/// Error: kInvalidArgument with the shapes if they fit no layout, and how many classes would fit, if that is known.
[[nodiscard]] Expected<DetectorLayout> RecogniseLayout(std::span<const std::vector<int>> shapes, std::size_t classes,
                                                       cv::Size input);

}  // namespace victorious
