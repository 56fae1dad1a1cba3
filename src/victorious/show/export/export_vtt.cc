#include "victorious/show/export/export_vtt.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/one_line.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/single_video.h"

namespace victorious {
namespace {

constexpr double kMinShown_s = 0.5;
constexpr double kMaxTime_s = 1e9;

struct VttCue {
  double begin_s = 0;
  double end_s = 0;
  const std::string* text = nullptr;
};

constexpr std::string_view kMark = "WEBVTT - victorious";

// hh:mm:ss.ttt
std::string TimeText(double time_s) {
  const auto all_ms = static_cast<std::int64_t>(std::llround(time_s * 1000));
  const std::int64_t seconds = all_ms / 1000;
  return fmt::format("{:02}:{:02}:{:02}.{:03}", seconds / 3600, seconds / 60 % 60, seconds % 60, all_ms % 1000);
}

// As text of a cue, on one line.
std::string EscapedCue(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else {
      escaped += c;
    }
  }
  return OneLine(escaped);
}

std::string TextOf(const ListedObject& listed) {
  std::string text = fmt::format("{} {}, score {:.3f}", listed.model, listed.object.id, listed.object.score);
  if (listed.object.place) text += fmt::format(", place within {:.2f} m in 90 %", listed.object.place->ce90_m);
  return EscapedCue(text);
}

Expected<std::vector<VttCue>> MakeCues(const ExportRequest& request, const std::map<std::int64_t, std::string>& texts) {
  std::vector<VttCue> cues;
  std::map<std::int64_t, std::size_t> last;  // by object, the index of its last cue
  VICTORIOUS_RETURN_IF_ERROR(request.store.VisitSightings(request.filter, [&](SightingRecord&& sighting) {
    const auto text = texts.find(sighting.object);
    if (text == texts.end()) return true;
    const double time_s = std::clamp(sighting.time_s, 0.0, kMaxTime_s);
    const auto known = last.find(sighting.object);
    if (known != last.end() && time_s - cues[known->second].end_s <= kMaxIntervalGap_s) {
      cues[known->second].end_s = time_s;
    } else {
      last[sighting.object] = cues.size();
      cues.push_back({time_s, time_s, &text->second});
    }
    return true;
  }));
  return cues;
}

Status WriteVtt(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_RETURN_IF_ERROR(FindSingleVideo(request, kVttFormat.name));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  std::map<std::int64_t, std::string> texts;  // by object
  for (const ListedObject& listed : objects) texts[listed.object.id] = TextOf(listed);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<VttCue> cues, MakeCues(request, texts));
  std::ranges::stable_sort(cues, {}, &VttCue::begin_s);
  out << kMark << "\n";
  for (const VttCue& cue : cues) {
    out << fmt::format("\n{} --> {}\n{}\n", TimeText(cue.begin_s),
                       TimeText(std::max(cue.end_s, cue.begin_s + kMinShown_s)), *cue.text);
  }
  return {};
}

}  // namespace

constinit const ExportFormat kVttFormat{.name = "vtt",
                                        .file = "a WebVTT text track of this program",
                                        .is_file = [](std::string_view head) { return head.starts_with(kMark); },
                                        .write = &WriteVtt};

}  // namespace victorious
