// Sightings of one video as CVAT for video 1.1, to be corrected there and trained on.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// A track for each object, with a key frame for each sighting; outside of the picture between its intervals
/// (single_video.h). Error: kInvalidArgument with more than one video.
extern const ExportFormat kCvatFormat;

}  // namespace victorious
