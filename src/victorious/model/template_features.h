// What a rendering of an object becomes: features that know their place on the object.
#pragma once

#include "victorious/base/error.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/model/cad_model.h"
#include "victorious/model/model_builder.h"
#include "victorious/render/relight.h"
#include "victorious/types/lit_templates.h"

namespace victorious {

/// The features that have a place on the object; none where there are fewer than options.least_features.
/// @param seen  what `picture` shows; the model is the world
Expected<LitTemplate> TemplateFeaturesOf(const ObjectPicture& picture, const SeenSurface& seen,
                                         const FeatureExtractor& extractor, const CadModelOptions& options);

}  // namespace victorious
