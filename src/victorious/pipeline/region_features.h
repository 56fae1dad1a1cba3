// The features of a part of a frame, where an object is expected.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/box.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// @param grey    the whole frame
/// @param region  px, may leave the frame
/// @return in the frame's pixels; none where the region lies outside
/// Errors: those of the extractor.
Expected<FeatureSet> FeaturesIn(const cv::Mat& grey, const Box& region, const FeatureExtractor& extractor);

}  // namespace victorious
