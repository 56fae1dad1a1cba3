#include "victorious/show/export/export_lines.h"

#include <ostream>

#include <nlohmann/json.hpp>

#include "victorious/base/enum_text.h"
#include "victorious/base/file_head.h"
#include "victorious/base/json.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/types/json_values.h"

namespace victorious {
namespace {

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

Status WriteObjects(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  for (const ListedObject& object : objects) out << DumpJson(ObjectJson(object)) << '\n';
  return {};
}

// Skips rows that another process adds during the export: their video or model may not be in the catalogue. The next
// export includes them.
Status WriteSightings(const ExportRequest& request, std::ostream& out) {
  return request.store.VisitSightings(request.filter, [&](SightingRecord&& sighting) {
    const VideoRecord* video = request.catalogue.Video(sighting.video);
    const ModelRecord* model = request.catalogue.Model(sighting.model);
    if (video != nullptr && model != nullptr) out << DumpJson(SightingJson(sighting, *video, *model)) << '\n';
    return out.good();
  });
}

}  // namespace

constinit const ExportFormat kObjectsFormat{
    .name = "objects",
    .file = "a list of objects (JSON Lines)",
    .is_file = [](std::string_view head) { return IsJsonLine(head, {"object_id", "rank", "first_time_s"}); },
    .write = &WriteObjects};

constinit const ExportFormat kSightingsFormat{
    .name = "sightings",
    .file = "a list of sightings (JSON Lines)",
    .is_file = [](std::string_view head) { return IsJsonLine(head, {"object_id", "video", "frame", "box"}); },
    .write = &WriteSightings};

}  // namespace victorious
