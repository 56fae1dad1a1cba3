// Private to jobs/: what a source of categories finds, as sightings, and what `index` says of the search.
#pragma once

#include <optional>

#include "victorious/jobs/index/index_pass.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/frame.h"

namespace victorious {

/// @param camera  at the time of the frame, if there is telemetry
[[nodiscard]] SightingRecord CategorySighting(const IndexPass& pass, const Frame& frame,
                                              const std::optional<CameraState>& camera, const FoundCategory& found);

/// Says how often a detector searches the video, and what it then does.
void TellOfDetector(const IndexPass& pass, const VideoInfo& info);

}  // namespace victorious
