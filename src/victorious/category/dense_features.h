// Descriptors on a grid, at several sizes, all upright: what a category is described by where keypoints are few. A grey
// image in; a FeatureSet in Lowe's layout out.
// Method: gradients of the smoothed image are spread over 8 orientations, each plane is averaged over cells, and 4 x 4
// cells about each grid point make a descriptor. Source: A. Bosch, A. Zisserman, X. Munoz, "Image classification using
// random forests and ferns", ICCV 2007 (dense SIFT at several sizes); descriptor: D. Lowe, IJCV 60(2), 2004.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"

namespace victorious {

struct DenseOptions {
  int step_px = 8;
  double smallest_cell_px = 4.0;
  int sizes = 6;
  double size_factor = 1.5;
  double least_contrast = 2.0;
  int max_side_px = 320;

  void ListFields(FieldList& fields);
};

/// @param grey  CV_8UC1, any size; images larger than max_side_px are searched at reduced size.
/// Keypoints are in pixels of `grey`, of orientation 0, size by size, row by row. A descriptor covers 4 x 4 cells; its
/// scale_px is a third of a cell, as Lowe's. Patches without contrast give none.
/// Cost: some 8 ms for 300 x 200 pixels at the default.
FeatureSet DenseFeatures(const cv::Mat& grey, const DenseOptions& options);

}  // namespace victorious
