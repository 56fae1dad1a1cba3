// jobs/, before every search for stored models: which engine makes the features of the scenes. Descriptors of
// different engines are not comparable, and a model's features are made when it is added, so the models decide.
#pragma once

#include <span>

#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Sets features.engine to the engine of the models; unchanged without models.
/// @param warn  receives one line if the engine changes; may be null
/// Errors: kInvalidArgument for models of different engines, with the name of one of each.
[[nodiscard]] Status AdoptEngineOfModels(std::span<const ObjectModel> models, FeatureOptions& features,
                                         const WarningSink& warn);

}  // namespace victorious
