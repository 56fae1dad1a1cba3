// From how an object stands before the camera to a sighting of a landmark, with what it is worth.
#pragma once

#include <optional>

#include "victorious/base/options.h"
#include "victorious/navigate/landmark.h"
#include "victorious/pipeline/stance.h"

namespace victorious {

/// @param least_turn_rad  how the object is turned is never known better than this: matched points err together
/// The frame and the candidates are left to the caller. Nothing where neither points nor a range tell its distance.
std::optional<LandmarkSighting> SightingOf(const Stance& stance, const SightOptions& options, double least_turn_rad);

}  // namespace victorious
