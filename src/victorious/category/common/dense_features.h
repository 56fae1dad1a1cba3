// Dense SIFT: upright descriptors on a regular grid at several scales, for category classification, where sparse
// keypoints are too few. Input: a grey image. Output: a FeatureSet with descriptors in Lowe's layout.
// Method: the gradient magnitudes of the smoothed image are assigned to 8 orientation planes by linear interpolation;
// each plane is averaged over cells; 4 x 4 cells around each grid point form a descriptor.
// Source: A. Bosch, A. Zisserman, X. Munoz, "Image classification using random forests and ferns", ICCV 2007 (dense
// SIFT at several scales); descriptor: D. Lowe, IJCV 60(2), 2004.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Side of a cell at the smallest scale; a patch has 4 x 4 cells.
inline constexpr double kDenseMinCell_px = 4.0;
/// Ratio of successive scales.
inline constexpr double kDenseSizeFactor = 1.5;
/// Patches with a lower mean gradient are omitted: uniform regions such as sky are uninformative. In grey levels per
/// pixel, root of the sum of squares over the cells.
inline constexpr double kDenseMinContrast = 2.0;

struct DenseOptions {
  int step_px = 8;
  int sizes = 6;
  int max_side_px = 320;

  void ListFields(FieldList& fields);
};

/// Computes dense descriptors.
/// @param grey  CV_8UC1, any size; an image whose longer side exceeds max_side_px is downscaled first
/// @return      keypoints in pixels of `grey`, with orientation 0, ordered by scale, then by row, then by column. A
///              descriptor covers 4 x 4 cells; scale_px is a third of a cell, as in Lowe's SIFT. Patches below
///              kDenseMinContrast are omitted.
/// Cost: about 8 ms for 300 x 200 pixels with the defaults.
FeatureSet DenseFeatures(const cv::Mat& grey, const DenseOptions& options);

}  // namespace victorious
