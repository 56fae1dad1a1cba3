#include "victorious/show/export/export_vmti.h"

#include <cmath>
#include <map>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/input/telemetry/st0601.h"
#include "victorious/show/export/single_video.h"
#include "victorious/show/export/vmti_packet.h"

namespace victorious {
namespace {

// A place is that of the time of the last sighting: it holds for each frame only if the object is not known to move.
Expected<std::map<std::int64_t, Geolocation>> StandingPlaces(const ExportRequest& request) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, request.store.Objects(request.filter));
  std::map<std::int64_t, Geolocation> places;
  for (const ObjectRecord& object : objects) {
    if (object.place && !object.place->IsMoving()) places.emplace(object.id, *object.place);
  }
  return places;
}

Status WriteVmti(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord* const video, FindSingleVideo(request, kVmtiFormat.name));
  if (video == nullptr) return {};
  if (!video->start_utc_us) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("format {}: {}: its UTC is not known, and packets have no other time: index it with "
                            "telemetry that has UTC",
                            kVmtiFormat.name, ShownName(*video)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto places, StandingPlaces(request));
  VmtiFrame frame{.frame = -1, .width = video->width, .height = video->height};
  const auto write = [&] {
    if (frame.targets.empty()) return;
    const std::vector<std::byte> packet = EncodeVmti(frame);
    out.write(reinterpret_cast<const char*>(packet.data()), static_cast<std::streamsize>(packet.size()));
    frame.targets.clear();
  };
  VICTORIOUS_RETURN_IF_ERROR(request.store.VisitSightings(request.filter, [&](SightingRecord&& sighting) {
    const ModelRecord* model = request.catalogue.Model(sighting.model);
    if (request.catalogue.Video(sighting.video) == nullptr || model == nullptr) return true;
    if (sighting.frame != frame.frame) write();
    frame.frame = sighting.frame;
    frame.utc_us = *video->start_utc_us + static_cast<std::int64_t>(std::llround(sighting.time_s * 1e6));
    const auto place = places.find(sighting.object);
    frame.targets.push_back({.id = sighting.object,
                             .box = sighting.box,
                             .confidence = sighting.score,
                             .label = model->name,
                             .place = place == places.end() ? std::nullopt : std::optional(place->second)});
    return out.good();
  }));
  write();
  return {};
}

// Not any KLV: telemetry that somebody recorded is not replaced.
bool IsVmti(std::string_view head) {
  constexpr std::size_t kSystemName = 64;  // it begins before this offset
  return head.size() > kUniversalLabelSize && IsSt0601Label(AsBytes(head).first(kUniversalLabelSize)) &&
         head.substr(0, kSystemName).contains(kVmtiSystem);
}

}  // namespace

constinit const ExportFormat kVmtiFormat{.name = "vmti",
                                         .file = "KLV with targets (VMTI) of this program",
                                         .is_binary = true,
                                         .is_file = &IsVmti,
                                         .write = &WriteVmti};

}  // namespace victorious
