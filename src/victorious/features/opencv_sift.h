// The `opencv` engine: OpenCV's SIFT, with its keypoints brought to the project's conventions.
#pragma once

#include <memory>

#include "victorious/features/feature_extractor.h"

namespace victorious {

std::unique_ptr<const FeatureExtractor> MakeOpenCvSift(const FeatureOptions& options);

}  // namespace victorious
