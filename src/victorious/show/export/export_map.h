// Exports geolocated objects as GeoJSON (RFC 7946) and KML 2.2.
#pragma once

#include <iosfwd>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// Writes one feature per object of known place: its point and its horizontal 90 % confidence ellipse.
[[nodiscard]] Status ExportGeoJson(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter,
                                   std::ostream& out);

/// Writes one placemark per object of known place, with the time span of its sightings and the same ellipse.
[[nodiscard]] Status ExportKml(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter,
                               std::ostream& out);

}  // namespace victorious
