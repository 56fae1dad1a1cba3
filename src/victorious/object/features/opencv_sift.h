// The `opencv` engine: OpenCV's SIFT, with keypoints converted to the project's conventions (README.md).
#pragma once

#include <memory>

#include "victorious/object/features/feature_extractor.h"

namespace victorious {

std::unique_ptr<const FeatureExtractor> MakeOpenCvSift(const FeatureOptions& options);

}  // namespace victorious
