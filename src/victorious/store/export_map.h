// Objects on the map: GeoJSON (RFC 7946) and KML 2.2.
#pragma once

#include <iosfwd>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// One feature an object of known place: its point and the horizontal ellipse that holds the truth in 90 %.
Status ExportGeoJson(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out);

/// One placemark an object of known place, shown while it was seen; the same ellipse.
Status ExportKml(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out);

}  // namespace victorious
