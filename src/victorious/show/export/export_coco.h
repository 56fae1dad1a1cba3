// COCO detection JSON.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// One COCO image per frame with a sighting, one category per model and one annotation per sighting. Streams the
/// annotations as they are read, and writes the images after them.
extern const ExportFormat kCocoFormat;

}  // namespace victorious
