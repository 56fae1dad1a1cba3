// Exports the content of an index for other programs. docs/formats/export.md describes every field.
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// All formats, in the order in which help names them.
[[nodiscard]] std::span<const ExportFormat* const> ExportFormats();

/// The names of the formats for `export --format`: "objects, sightings, ...".
[[nodiscard]] std::string ExportFormatNames();

/// The format of `export --format`. Error: kInvalidArgument with the list of names.
[[nodiscard]] Expected<const ExportFormat*> FindExportFormat(std::string_view name);

/// Writes the rows that match the filter, one by one. Errors: kNotFound for a video or model that is not in the index
/// (the message lists those that are); kInvalidArgument for a format of one video with more than one, or for
/// ExportOptions::cot_type; kNoSpace and others of `out`.
[[nodiscard]] Status Export(IndexStore& store, const ExportFormat& format, const SightingFilter& filter,
                            std::ostream& out, const ExportOptions& options = {});

}  // namespace victorious
