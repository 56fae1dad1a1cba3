#include "victorious/show/export/export_mot.h"

#include <algorithm>
#include <ostream>

#include <fmt/format.h>

#include "victorious/base/file_head.h"
#include "victorious/show/export/single_video.h"

namespace victorious {
namespace {

bool IsMot(std::string_view head) {
  constexpr int kCommas = 9;
  const std::string_view line = FirstLine(head);
  return IsTextOf(line, "0123456789.,-+e") && std::ranges::count(line, ',') == kCommas;
}

Status WriteMot(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_RETURN_IF_ERROR(FindSingleVideo(request, kMotFormat.name));
  return request.store.VisitSightings(request.filter, [&](SightingRecord&& s) {
    if (request.catalogue.Video(s.video) == nullptr) return true;
    out << fmt::format("{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.4f},-1,-1,-1\n", s.frame + 1, s.object, s.box.x, s.box.y,
                       s.box.width, s.box.height, s.score);
    return out.good();
  });
}

}  // namespace

constinit const ExportFormat kMotFormat{
    .name = "mot", .file = "a MOTChallenge text", .is_file = &IsMot, .write = &WriteMot};

}  // namespace victorious
