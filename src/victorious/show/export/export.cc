#include "victorious/show/export/export.h"

#include <array>
#include <cerrno>
#include <optional>
#include <ostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/check.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/json.h"
#include "victorious/show/export/export_coco.h"
#include "victorious/show/export/export_gpkg.h"
#include "victorious/show/export/export_map.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/store/catalogue.h"
#include "victorious/types/json_values.h"

namespace victorious {
namespace {

constexpr auto kFormats = std::to_array<EnumText<ExportFormat>>({{ExportFormat::kObjects, "objects"},
                                                                 {ExportFormat::kSightings, "sightings"},
                                                                 {ExportFormat::kMot, "mot"},
                                                                 {ExportFormat::kCoco, "coco"},
                                                                 {ExportFormat::kGeoJson, "geojson"},
                                                                 {ExportFormat::kKml, "kml"},
                                                                 {ExportFormat::kGpkg, "gpkg"},
                                                                 {ExportFormat::kCot, "cot"}});

Json ViewJson(const SightingRecord& sighting) {
  return {{"azimuth_deg", sighting.view ? DegreesJson(sighting.view->azimuth_rad) : Json()},
          {"off_nadir_deg", sighting.view ? DegreesJson(sighting.view->off_nadir_rad) : Json()},
          {"in_plane_deg", DegreesJson(sighting.in_plane_rad)}};
}

Json SightingJson(const SightingRecord& sighting, const VideoRecord& video, const ModelRecord& model) {
  return {{"object_id", sighting.object},
          {"model", model.IsCategory() ? Json() : Json(model.name)},
          {"category", model.IsCategory() ? Json(model.name) : Json()},
          {"video", ShownName(video)},
          {"frame", sighting.frame},
          {"time_s", TimeJson(sighting.time_s)},
          {"box", BoxJson(sighting.box)},
          {"score", ScoreJson(sighting.score)},
          {"source", ToText(sighting.source)},
          {"matches", model.IsCategory() ? Json() : Json(sighting.matches)},
          {"view", model.IsCategory() ? Json() : ViewJson(sighting)},
          {"sigma_view_deg", OrNull(sighting.sigma_view_rad, &DegreesJson)},
          {"distance_m", OrNull(sighting.distance_m, &MetresJson)},
          {"sigma_distance_m", OrNull(sighting.sigma_distance_m, &MetresJson)},
          {"view_index", model.IsCategory() ? Json() : Json(sighting.view_index)},
          {"outline", OutlineJson(sighting.outline)}};
}

Status ExportObjects(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects, ListObjects(store, catalogue, filter));
  for (const ListedObject& object : objects) out << DumpJson(ObjectJson(object)) << '\n';
  return {};
}

// Skips rows that another process adds during the export: their video or model may not be in the catalogue. The next
// export includes them.
Status ExportSightings(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out) {
  return store.VisitSightings(filter, [&](SightingRecord&& sighting) {
    const VideoRecord* video = catalogue.Video(sighting.video);
    const ModelRecord* model = catalogue.Model(sighting.model);
    if (video != nullptr && model != nullptr) out << DumpJson(SightingJson(sighting, *video, *model)) << '\n';
    return out.good();
  });
}

Status ExportMot(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out) {
  if (catalogue.videos().size() > 1) {
    std::string names;
    for (const VideoRecord& video : catalogue.videos()) names += (names.empty() ? "" : ", ") + ShownName(video);
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("format mot needs a single video, but these match: {}: select one with --video", names));
  }
  return store.VisitSightings(filter, [&](SightingRecord&& s) {
    if (catalogue.Video(s.video) == nullptr) return true;
    out << fmt::format("{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.4f},-1,-1,-1\n", s.frame + 1, s.object, s.box.x, s.box.y,
                       s.box.width, s.box.height, s.score);
    return out.good();
  });
}

Status Write(IndexStore& store, ExportFormat format, const Catalogue& catalogue, const SightingFilter& filter,
             const CotOptions& cot, std::ostream& out) {
  switch (format) {
    case ExportFormat::kObjects:
      return ExportObjects(store, catalogue, filter, out);
    case ExportFormat::kSightings:
      return ExportSightings(store, catalogue, filter, out);
    case ExportFormat::kMot:
      return ExportMot(store, catalogue, filter, out);
    case ExportFormat::kCoco:
      return ExportCoco(store, catalogue, filter, out);
    case ExportFormat::kGeoJson:
      return ExportGeoJson(store, catalogue, filter, out);
    case ExportFormat::kKml:
      return ExportKml(store, catalogue, filter, out);
    case ExportFormat::kGpkg:
      return ExportGpkg(store, catalogue, filter, out);
    case ExportFormat::kCot:
      return ExportCot(store, catalogue, filter, cot, out);
  }
  VICTORIOUS_CHECK(false);
}

}  // namespace

std::string ExportFormatNames() {
  std::string names;
  for (const auto& [format, name] : kFormats) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

Expected<ExportFormat> ParseExportFormat(std::string_view name) {
  if (const std::optional<ExportFormat> format = FromText(kFormats, name)) return *format;
  return Fail(ErrorCode::kInvalidArgument, fmt::format("format {}: unknown: use one of {}", name, ExportFormatNames()));
}

Status Export(IndexStore& store, ExportFormat format, const SightingFilter& filter, std::ostream& out,
              const CotOptions& cot) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, filter));
  errno = 0;
  VICTORIOUS_RETURN_IF_ERROR(Write(store, format, catalogue, filter, cot, out));
  out.flush();
  if (out.good()) return {};
  // A stream reports only that it failed; errno, if set, gives the reason.
  return std::unexpected(errno != 0 ? ErrorFromErrno(errno, "write the export")
                                    : Error{ErrorCode::kInternal, "write the export: the output stream failed"});
}

}  // namespace victorious
