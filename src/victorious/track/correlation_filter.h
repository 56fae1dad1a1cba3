// track/: a multi-channel correlation filter that localises an object in a window, updated with one window a frame.
//
// The filter is zero outside the object, so that the window may be much larger than the object and all its shifts serve
// as background samples. A temporal term keeps the filter near that of the previous frame, which limits the damage of
// one bad frame:
//
//   min over f:  1/2 |sum_d f_d (x) x_d - y|^2  +  mu/2 sum_d |f_d - f_d,before|^2,   f = 0 outside the object
//
// x are the window's channels, y is a Gaussian at its centre, (x) is circular correlation. Solved by a few ADMM steps:
// the two terms per frequency (a rank-one matrix plus a multiple of the identity), the constraint per cell.
// Sources: H. K. Galoogahi, A. Fagg, S. Lucey, "Learning background-aware correlation filters for visual tracking",
// ICCV 2017; F. Li, C. Tian, W. Zuo, L. Zhang, M.-H. Yang, "Learning spatial-temporal regularized correlation filters
// for visual tracking", CVPR 2018.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/track/cell_features.h"

namespace victorious {

struct FilterShape {
  cv::Size cells;           ///< size of the window, cells
  cv::Size2f object_cells;  ///< size of the object at the window's centre, cells
};

/// The filter's response over a window.
struct FilterResponse {
  cv::Mat map;           ///< CV_32F; the window's centre is at (columns / 2, rows / 2)
  cv::Point2d peak;      ///< cells from the window's centre, sub-cell accuracy
  double height = 0;     ///< value at the peak; about 1 on the training window
  double sharpness = 0;  ///< peak-to-sidelobe ratio: (peak - mean) / standard deviation of the rest
};

class CorrelationFilter {
 public:
  explicit CorrelationFilter(const FilterShape& shape);

  [[nodiscard]] const FilterShape& shape() const { return shape_; }

  /// Updates the filter with a window whose centre is the object's. The first call creates the filter.
  /// @param temporal_weight  mu in units of the mean spectral energy of the window's cells; larger: the filter changes
  ///   more slowly
  void Update(const CellFeatures& window, double temporal_weight);

  /// Correlates the filter with the window.
  [[nodiscard]] FilterResponse ComputeResponse(const CellFeatures& window) const;

 private:
  [[nodiscard]] std::vector<cv::Mat> ComputeSpectra(const CellFeatures& window) const;

  FilterShape shape_;
  cv::Mat taper_;                // Hann window
  cv::Mat mask_;                 // 1 on the object, 0 outside
  cv::Mat desired_spectrum_;     // spectrum of y, real
  std::vector<cv::Mat> filter_;  // spectra, one per channel
};

}  // namespace victorious
