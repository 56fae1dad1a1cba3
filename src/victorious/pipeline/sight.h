// From how an object stands before the camera, and the camera's state, to the line along which it was seen, its range
// and its heading.
//
// The line goes to the middle of the object (stance.h); of models that know their points, the front gives the heading.
#pragma once

#include <optional>

#include "victorious/pipeline/stance.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/sight.h"

namespace victorious {

/// @param camera  at the frame's time
/// Nothing where the camera's state is not complete.
std::optional<Sight> SightOf(const Stance& stance, const CameraState& camera);

}  // namespace victorious
