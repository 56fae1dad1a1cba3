#include "victorious/show/export/export.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <ostream>

#include <fmt/format.h>

#include "victorious/show/export/export_coco.h"
#include "victorious/show/export/export_cot.h"
#include "victorious/show/export/export_cvat.h"
#include "victorious/show/export/export_czml.h"
#include "victorious/show/export/export_gpkg.h"
#include "victorious/show/export/export_lines.h"
#include "victorious/show/export/export_map.h"
#include "victorious/show/export/export_mot.h"
#include "victorious/show/export/export_vmti.h"
#include "victorious/show/export/export_vtt.h"
#include "victorious/store/catalogue.h"

namespace victorious {
namespace {

constexpr auto kFormats = std::to_array<const ExportFormat*>(
    {&kObjectsFormat, &kSightingsFormat, &kMotFormat, &kCocoFormat, &kCvatFormat, &kVttFormat, &kVmtiFormat,
     &kGeoJsonFormat, &kKmlFormat, &kGpkgFormat, &kCotFormat, &kCzmlFormat});

}  // namespace

std::span<const ExportFormat* const> ExportFormats() { return kFormats; }

std::string ExportFormatNames() {
  std::string names;
  for (const ExportFormat* format : kFormats) names += (names.empty() ? "" : ", ") + std::string(format->name);
  return names;
}

Expected<const ExportFormat*> FindExportFormat(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name, &ExportFormat::name);
  if (found != kFormats.end()) return *found;
  return Fail(ErrorCode::kInvalidArgument, fmt::format("format {}: unknown: use one of {}", name, ExportFormatNames()));
}

Status Export(IndexStore& store, const ExportFormat& format, const SightingFilter& filter, std::ostream& out,
              const ExportOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, filter));
  errno = 0;
  VICTORIOUS_RETURN_IF_ERROR(
      format.write({.store = store, .catalogue = catalogue, .filter = filter, .options = options}, out));
  out.flush();
  if (out.good()) return {};
  // A stream reports only that it failed; errno, if set, gives the reason.
  return std::unexpected(errno != 0 ? ErrorFromErrno(errno, "write the export")
                                    : Error{ErrorCode::kInternal, "write the export: the output stream failed"});
}

}  // namespace victorious
