// Sightings of one video as MOTChallenge text.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// Error: kInvalidArgument with more than one video.
extern const ExportFormat kMotFormat;

}  // namespace victorious
