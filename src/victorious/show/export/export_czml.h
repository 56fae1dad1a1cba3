// Geolocated objects as CZML, for globes of Cesium.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// A packet for each object of known place: a point, a label, its horizontal 90 % confidence ellipse, and, where the
/// videos tell UTC, the time from its first to its last sighting.
extern const ExportFormat kCzmlFormat;

}  // namespace victorious
