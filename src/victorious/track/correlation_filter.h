// track/, a filter that answers with a peak where the object is: a correlation over many channels of cells, learnt from
// one window a frame. It is zero outside the object, so that a window may be much larger than the object and all of its
// shifts teach what is background; and it is held near the one of the frame before, so that one bad frame spoils
// little:
//
//   min over f:  1/2 |sum_d f_d (x) x_d - y|^2  +  mu/2 sum_d |f_d - f_d,before|^2,   f = 0 outside the object
//
// with x the window's channels and y a Gaussian at its centre. Solved by a few steps of ADMM: the two terms frequency
// by frequency (a matrix of rank one plus a multiple of the identity), the constraint cell by cell. Sources: H. K.
// Galoogahi, A. Fagg, S. Lucey, "Learning background-aware correlation filters for visual tracking", ICCV 2017; F. Li,
// C. Tian, W. Zuo, L. Zhang, M.-H. Yang, "Learning spatial-temporal regularized correlation filters for visual
// tracking", CVPR 2018.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/track/cell_features.h"

namespace victorious {

struct FilterShape {
  cv::Size cells;           ///< of the window
  cv::Size2f object_cells;  ///< the object's size in it, in the middle
};

/// The filter's answer over a window.
struct FilterResponse {
  cv::Mat map;           ///< CV_32F; the window's centre is at (columns / 2, rows / 2)
  cv::Point2d peak;      ///< cells from the window's centre, to parts of a cell
  double height = 0;     ///< of the peak; about 1 on what was learnt
  double sharpness = 0;  ///< the peak's height over the mean of the rest, in the rest's deviations
};

class CorrelationFilter {
 public:
  explicit CorrelationFilter(const FilterShape& shape);

  [[nodiscard]] const FilterShape& shape() const { return shape_; }

  /// Learns the window, in whose middle the object is. The first call makes the filter.
  /// @param stay  mu: how strongly it is held near what it was, in units of the window's energy
  void Learn(const CellFeatures& window, double stay);

  /// Where in the window the object is.
  [[nodiscard]] FilterResponse Respond(const CellFeatures& window) const;

 private:
  [[nodiscard]] std::vector<cv::Mat> Spectra(const CellFeatures& window) const;

  FilterShape shape_;
  cv::Mat taper_;                // falls to 0 towards the window's edge
  cv::Mat mask_;                 // 1 on the object, 0 outside it
  cv::Mat wanted_;               // the spectrum of y, real
  std::vector<cv::Mat> filter_;  // spectra
};

}  // namespace victorious
