// Exports geolocated objects as GeoJSON (RFC 7946) and KML 2.2.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// One feature per object of known place: its point and its horizontal 90 % confidence ellipse.
extern const ExportFormat kGeoJsonFormat;

/// One placemark per object of known place, with the time span of its sightings and the same ellipse.
extern const ExportFormat kKmlFormat;

}  // namespace victorious
