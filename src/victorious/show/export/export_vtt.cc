#include "victorious/show/export/export_vtt.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
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

constexpr double kMinShown_s = 0.5;

struct Cue {
  double begin_s = 0;
  double end_s = 0;
  std::string text;
};

// hh:mm:ss.ttt; times before the video's first frame are 0, since WebVTT has none.
std::string TimeText(double time_s) {
  const auto all_ms = static_cast<std::int64_t>(std::llround(std::max(time_s, 0.0) * 1000));
  const std::int64_t seconds = all_ms / 1000;
  return fmt::format("{:02}:{:02}:{:02}.{:03}", seconds / 3600, seconds / 60 % 60, seconds % 60, all_ms % 1000);
}

std::string CueText(const ListedObject& listed) {
  std::string text = fmt::format("{} {}, score {:.3f}", listed.model, listed.object.id, listed.object.score);
  if (listed.object.place) text += fmt::format(", place within {:.2f} m", listed.object.place->ce90_m);
  return EscapedXml(text);  // cues escape &, < and > as XML does
}

Status WriteVtt(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_RETURN_IF_ERROR(FindSingleVideo(request, kVttFormat.name));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  std::vector<Cue> cues;
  for (const ListedObject& listed : objects) {
    const auto extend = [&](const SightingRecord& sighting, bool begins) {
      if (begins) cues.push_back({sighting.time_s, sighting.time_s, CueText(listed)});
      cues.back().end_s = sighting.time_s;
    };
    VICTORIOUS_RETURN_IF_ERROR(VisitIntervals(request, listed.object.id, extend));
  }
  std::ranges::stable_sort(cues, {}, &Cue::begin_s);
  out << "WEBVTT\n";
  for (const Cue& cue : cues) {
    out << fmt::format("\n{} --> {}\n{}\n", TimeText(cue.begin_s),
                       TimeText(std::max(cue.end_s, cue.begin_s + kMinShown_s)), cue.text);
  }
  return {};
}

}  // namespace

constinit const ExportFormat kVttFormat{.name = "vtt",
                                        .file = "a WebVTT text track",
                                        .is_file = [](std::string_view head) { return head.starts_with("WEBVTT"); },
                                        .write = &WriteVtt};

}  // namespace victorious
