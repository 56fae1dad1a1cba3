// Exports geolocated objects as a GeoPackage (OGC 12-128, an SQLite file), written by GDAL/OGR.
#pragma once

#include <iosfwd>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// Writes two layers: `objects`, one point per object of known place, and `ellipses`, its horizontal 90 % confidence
/// ellipse. Both have the columns of the format `objects`; arrays are JSON text. The same content gives the same bytes.
/// The file is made in memory. Error: kInternal with OGR's message.
[[nodiscard]] Status ExportGpkg(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter,
                                std::ostream& out);

}  // namespace victorious
