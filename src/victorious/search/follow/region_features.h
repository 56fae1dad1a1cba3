// Extracts features in a region of interest of a frame.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Extracts the features of a region.
/// @param grey    the whole frame, CV_8U
/// @param region  px, may leave the frame
/// @return keypoints in pixels of the whole frame; empty if the region lies outside
/// Errors: those of the extractor.
[[nodiscard]] Expected<FeatureSet> FeaturesIn(const cv::Mat& grey, const Box& region,
                                              const FeatureExtractor& extractor);

}  // namespace victorious
