#include "victorious/show/export/export_cvat.h"

#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/single_video.h"
#include "victorious/show/export/xml_text.h"

namespace victorious {
namespace {

// CVAT does not write it: what a person has corrected there is not replaced.
constexpr std::string_view kMark = "<!-- victorious -->";

std::string MetaText(const VideoRecord& video, const std::vector<ModelRecord>& models) {
  std::string labels;
  for (const ModelRecord& model : models) {
    labels += fmt::format("<label><name>{}</name><attributes></attributes></label>\n", EscapedXml(model.name));
  }
  const std::string size = video.frame_count ? fmt::format("<size>{}</size>", *video.frame_count) : "";
  return fmt::format(
      "<meta><task><name>{}</name>{}<mode>interpolation</mode>\n<labels>\n{}</labels>\n"
      "<original_size><width>{}</width><height>{}</height></original_size></task></meta>\n",
      EscapedXml(ShownName(video)), size, labels, video.width, video.height);
}

std::string BoxText(std::int64_t frame, const Box& box, bool is_outside) {
  return fmt::format(
      "<box frame=\"{}\" keyframe=\"1\" outside=\"{}\" occluded=\"0\" xtl=\"{:.2f}\" ytl=\"{:.2f}\" xbr=\"{:.2f}\" "
      "ybr=\"{:.2f}\" z_order=\"0\"></box>\n",
      frame, is_outside ? 1 : 0, box.x, box.y, box.x + box.width, box.y + box.height);
}

// CVAT repeats a box until the next key frame of its track: after the last one of an interval it is outside.
void WriteEnd(const SightingRecord& last, const VideoRecord& video, std::ostream& out) {
  if (last.frame + 1 != video.frame_count) out << BoxText(last.frame + 1, last.box, true);
}

// True if the object is out of view between two of its sightings; successive frames never are.
bool HasGap(const SightingRecord& before, const SightingRecord& after) {
  return after.time_s - before.time_s > kMaxIntervalGap_s && after.frame > before.frame + 1;
}

Status WriteTrack(const ListedObject& listed, const ExportRequest& request, const VideoRecord& video,
                  std::ostream& out) {
  SightingFilter filter = request.filter;
  filter.object = listed.object.id;
  std::optional<SightingRecord> last;
  out << fmt::format("<track id=\"{}\" label=\"{}\" source=\"auto\">\n", listed.object.id, EscapedXml(listed.model));
  VICTORIOUS_RETURN_IF_ERROR(request.store.VisitSightings(filter, [&](SightingRecord&& sighting) {
    if (sighting.video != video.id) return true;
    if (last && HasGap(*last, sighting)) WriteEnd(*last, video, out);
    out << BoxText(sighting.frame, sighting.box, false);
    last = std::move(sighting);
    return out.good();
  }));
  if (last) WriteEnd(*last, video, out);
  out << "</track>\n";
  return {};
}

Status WriteCvat(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord* const video, FindSingleVideo(request, kCvatFormat.name));
  out << "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n" << kMark << "\n<annotations>\n<version>1.1</version>\n";
  if (video != nullptr) {
    out << MetaText(*video, request.catalogue.models());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                                ListObjects(request.store, request.catalogue, request.filter));
    for (const ListedObject& listed : objects) VICTORIOUS_RETURN_IF_ERROR(WriteTrack(listed, request, *video, out));
  }
  out << "</annotations>\n";
  return {};
}

}  // namespace

constinit const ExportFormat kCvatFormat{
    .name = "cvat",
    .file = "a file for CVAT of this program",
    .is_file = [](std::string_view head) { return head.contains(kMark) && head.contains("<annotations>"); },
    .write = &WriteCvat};

}  // namespace victorious
