// From a detection and the camera's state to the line along which the object was seen, its range and its heading.
//
// The line goes to the middle of the object (stance.h); of models that know their points, the front gives the heading.
#pragma once

#include <optional>

#include "victorious/pipeline/stance.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"
#include "victorious/types/sight.h"

namespace victorious {

/// @param scene   the frame's features, which the detection's matches count in
/// @param camera  at the frame's time
/// Nothing where the camera's state is not complete, or the detection does not tell where the object's middle is.
std::optional<Sight> SightOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                             const CameraState& camera, const SightOptions& options);

}  // namespace victorious
