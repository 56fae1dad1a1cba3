// Objects and sightings as JSON Lines.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// Best object first.
extern const ExportFormat kObjectsFormat;

/// By video and frame.
extern const ExportFormat kSightingsFormat;

}  // namespace victorious
