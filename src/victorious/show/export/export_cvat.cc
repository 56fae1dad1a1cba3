#include "victorious/show/export/export_cvat.h"

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/object_intervals.h"
#include "victorious/show/export/single_video.h"
#include "victorious/show/export/xml_text.h"

namespace victorious {
namespace {

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
void WriteEnd(const std::optional<SightingRecord>& last, const VideoRecord& video, std::ostream& out) {
  if (last && last->frame + 1 != video.frame_count) out << BoxText(last->frame + 1, last->box, true);
}

Status WriteTrack(const ListedObject& listed, const ExportRequest& request, const VideoRecord& video,
                  std::ostream& out) {
  std::optional<SightingRecord> last;
  out << fmt::format("<track id=\"{}\" label=\"{}\" source=\"auto\">\n", listed.object.id, EscapedXml(listed.model));
  VICTORIOUS_RETURN_IF_ERROR(VisitIntervals(request, listed.object.id, [&](const SightingRecord& one, bool begins) {
    if (begins) WriteEnd(last, video, out);
    out << BoxText(one.frame, one.box, false);
    last = one;
  }));
  WriteEnd(last, video, out);
  out << "</track>\n";
  return {};
}

Status WriteCvat(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord* const video, FindSingleVideo(request, kCvatFormat.name));
  out << "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<annotations>\n<version>1.1</version>\n";
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
    .file = "an annotation file of CVAT",
    .is_file = [](std::string_view head) { return head.contains("<annotations>"); },
    .write = &WriteCvat};

}  // namespace victorious
