// The `sift` engine: the project's own SIFT, in integers, the same bits on every instruction set (README.md).
#pragma once

#include <memory>

#include "victorious/object/features/feature_extractor.h"

namespace victorious {

std::unique_ptr<const FeatureExtractor> MakeSift(const FeatureOptions& options);

}  // namespace victorious
