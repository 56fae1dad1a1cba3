// Exports how well the ground was searched (types/ground_coverage.h): as a GeoTIFF with a band for each number, and as
// GeoJSON with polygons of equal probability and gaps to fly again. docs/formats/export.md describes both. Hides GDAL.
#pragma once

#include <iosfwd>

#include "victorious/base/error.h"
#include "victorious/types/ground_coverage.h"
#include "victorious/types/json_values.h"

namespace victorious {

/// Bands of 32-bit floats, named: looks, views, off_nadir_deg, and of each model its probability and size_px. Cells
/// outside of the area are -1, the no-data value. WGS 84. The same content gives the same bytes. Error: kInternal with
/// GDAL's message.
[[nodiscard]] Status WriteCoverageTiff(const GroundCoverage& coverage, std::ostream& out);

/// RFC 7946. Of each model: a MultiPolygon for each tenth of probability (`kind` "probability"), and each connected
/// piece of the area with less than `min_probability`, largest first (`kind` "gap"). Error: kInternal with GDAL's
/// message.
[[nodiscard]] Status WriteCoverageGeoJson(const GroundCoverage& coverage, double min_probability, std::ostream& out);

/// The fraction of the area's cells in which a model would have been found with this probability or more; 0 without an
/// area.
[[nodiscard]] double FractionFound(const GroundCoverage& coverage, const ModelCoverage& model, double min_probability);

/// The area that was to be searched, m2.
[[nodiscard]] double AreaOf(const GroundCoverage& coverage);

/// The summary: area_m2, cell_m, min_probability, and of each model the fraction of the area that was searched with it.
[[nodiscard]] Json CoverageSummaryJson(const GroundCoverage& coverage, double min_probability);

}  // namespace victorious
