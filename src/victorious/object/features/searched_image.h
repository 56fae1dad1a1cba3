// features/, before and after every engine: what is searched instead of the given image, and keypoints of one in pixels
// of the other.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Removes salt-and-pepper noise (FeatureOptions::impulse_fraction) and reduces the image to
/// FeatureOptions::max_side_px.
/// @param grey  CV_8UC1
/// @return CV_8UC1, at least 8 px on each side; empty if the image is too small for a keypoint
/// Errors: kInternal for an exception of OpenCV.
[[nodiscard]] Expected<cv::Mat> MakeSearchedImage(const cv::Mat& grey, const FeatureOptions& options);

/// Converts keypoints from pixels of the searched image to pixels of the given one.
void ScaleKeypoints(const cv::Size& searched, const cv::Size& given, FeatureSet& features);

}  // namespace victorious
