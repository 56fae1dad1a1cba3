// What was found, as text that other programs read. docs/formats/export.md describes every field.
#pragma once

#include <iosfwd>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"

namespace victorious {

enum class ExportFormat {
  kObjects,    ///< JSON Lines, best object first
  kSightings,  ///< JSON Lines, by video and frame
  kMot,        ///< MOTChallenge text of one video
  kCoco,       ///< COCO detection JSON
  kGeoJson,    ///< RFC 7946: objects of known place
  kKml,        ///< the same for Google Earth
};

/// By the name that `export --format` takes. kInvalidArgument with the list of names.
Expected<ExportFormat> ParseExportFormat(std::string_view name);

/// Writes what the filter lets through, row by row. Errors: kNotFound for a video or model that is not in the index (it
/// lists those that are); kInvalidArgument for kMot with more than one video; kNoSpace and others of `out`.
Status Export(IndexStore& store, ExportFormat format, const SightingFilter& filter, std::ostream& out);

}  // namespace victorious
