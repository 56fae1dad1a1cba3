// Extracts the features of a rendering, with their 3D points on the object from its depth map.
#pragma once

#include "victorious/base/error.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/model_builder.h"
#include "victorious/object/render/relight.h"

namespace victorious {

/// The features on the object that have a depth; empty if there are fewer than options.min_features.
/// @param depth_map  of the pixels of `image`; its world frame is the model frame
/// Errors: those of the extractor.
[[nodiscard]] Expected<RelitTemplate> ExtractTemplateFeatures(const ObjectImage& image, const PosedDepthMap& depth_map,
                                                              const FeatureExtractor& extractor,
                                                              const CadModelOptions& options);

}  // namespace victorious
