// Exports the content of an index for other programs. docs/formats/export.md describes every field.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/show/export/export_cot.h"
#include "victorious/store/index_store.h"

namespace victorious {

enum class ExportFormat {
  kObjects,    ///< JSON Lines, best object first
  kSightings,  ///< JSON Lines, by video and frame
  kMot,        ///< MOTChallenge text of one video
  kCoco,       ///< COCO detection JSON
  kGeoJson,    ///< RFC 7946: objects of known place
  kKml,        ///< KML 2.2: objects of known place, for Google Earth
  kGpkg,       ///< GeoPackage, binary: objects of known place, for GIS programs
  kCot,        ///< Cursor-on-Target 2.0: objects of known place, for ATAK and TAK servers
};

/// The names of the formats for `export --format`: "objects, sightings, ...".
std::string ExportFormatNames();

/// Parses the argument of `export --format`. Error: kInvalidArgument with the list of names.
[[nodiscard]] Expected<ExportFormat> ParseExportFormat(std::string_view name);

/// Writes the rows that match the filter, one by one. Errors: kNotFound for a video or model that is not in the index
/// (the message lists those that are); kInvalidArgument for kMot with more than one video, or for CotOptions::type;
/// kNoSpace and others of `out`.
/// @param cot  of kCot
[[nodiscard]] Status Export(IndexStore& store, ExportFormat format, const SightingFilter& filter, std::ostream& out,
                            const CotOptions& cot = {});

}  // namespace victorious
