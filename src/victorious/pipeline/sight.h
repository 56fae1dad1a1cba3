// From how an object stands before the camera, and the camera's state, to the line along which it was seen, its range
// and its heading.
//
// The line goes to the middle of the object (stance.h); of models that know their points, the front gives the heading.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/pipeline/stance.h"
#include "victorious/store/index_store.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/sight.h"

namespace victorious {

/// @param camera  at the frame's time
/// Nothing where the camera's state is not complete.
std::optional<Sight> SightOf(const Stance& stance, const CameraState& camera);

/// Sight::recognition of a run's next sight: where it was only followed, that of the one before it (or null); else a
/// new one.
/// @param recognitions  how many there are; counts on
std::int64_t RecognitionOf(const SightingRecord& sighting, const Sight* before, std::int64_t& recognitions);

}  // namespace victorious
