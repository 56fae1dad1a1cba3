#include "victorious/show/export/export_cot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/enum_text.h"
#include "victorious/base/file.h"
#include "victorious/base/one_line.h"
#include "victorious/base/utc.h"
#include "victorious/base/without_folders.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/xml_text.h"
#include "victorious/types/ground_motion.h"

namespace victorious {
namespace {

struct CotWord {
  std::string_view word;
  std::string_view type;
};

// Words of names, with types of MIL-STD-2525 in the notation of Cursor-on-Target; u: affiliation unknown.
constexpr auto kCotWords = std::to_array<CotWord>({
    {"aircraft", "a-u-A"},       {"airplane", "a-u-A-C-F"}, {"plane", "a-u-A-C-F"},    {"jet", "a-u-A"},
    {"helicopter", "a-u-A-C-H"}, {"drone", "a-u-A-M-F-Q"},  {"boat", "a-u-S"},         {"ship", "a-u-S"},
    {"vessel", "a-u-S"},         {"bus", "a-u-G-E-V-C"},    {"car", "a-u-G-E-V-C"},    {"jeep", "a-u-G-E-V"},
    {"lorry", "a-u-G-E-V"},      {"pickup", "a-u-G-E-V-C"}, {"tank", "a-u-G-E-V-A-T"}, {"truck", "a-u-G-E-V"},
    {"van", "a-u-G-E-V-C"},      {"vehicle", "a-u-G-E-V"},  {"person", "a-u-G"},       {"building", "a-u-G-I"},
});

bool IsAsciiWord(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

// The same for each export of one index, and for every index of the same videos and models; another for others.
std::string UidOf(const ObjectRecord& object, const Catalogue& everything) {
  std::string contents;
  if (const ModelRecord* model = everything.Model(object.model)) contents = model->content_id;
  if (const VideoRecord* video = object.videos.empty() ? nullptr : everything.Video(object.videos.front())) {
    contents += "\n" + video->content_id;
  }
  return fmt::format("victorious-{:016x}-{}", Checksum(std::as_bytes(std::span(contents))), object.id);
}

// UTC of the last sighting: the latest of the videos; std::nullopt if none tells it.
std::optional<std::int64_t> LastSeenUtc(const ListedObject& listed) {
  std::optional<std::int64_t> last_us;
  for (const ObjectMoment& moment : listed.moments) {
    const std::optional<std::int64_t> utc_us = moment.UtcOf(moment.last_time_s);
    if (utc_us && (!last_us || *utc_us > *last_us)) last_us = utc_us;
  }
  return last_us;
}

std::string RemarksOf(const ListedObject& listed) {
  const ObjectRecord& object = listed.object;
  std::string text = fmt::format("score {:.3f}, {} frames, CE90 {:.2f} m, LE90 {:.2f} m", object.score, object.frames,
                                 object.place->ce90_m, object.place->le90_m);
  if (object.heading_rad) text += fmt::format(", heading {:.0f} degrees", DegreesFromRadians(*object.heading_rad));
  if (!object.rejected.empty()) text += ", rejected: " + object.rejected;
  // Events go to others, whom the folders of this machine do not concern.
  std::vector<std::string> videos;
  for (const std::string& video : listed.videos) videos.push_back(WithoutFolders(video));
  return text + fmt::format("; {}", fmt::join(videos, ", "));
}

std::string EventText(const ListedObject& listed, const Catalogue& everything, std::string_view type,
                      std::int64_t now_us) {
  const Geolocation& place = *listed.object.place;
  const std::optional<std::int64_t> seen_us = LastSeenUtc(listed);
  const std::int64_t start_us = seen_us.value_or(now_us);
  const std::int64_t stale_us = place.IsMoving() ? start_us + kCotMovingUs : now_us + kCotStandingUs;
  std::string track;
  if (const auto motion = ComputeGroundMotion(place)) {
    track = fmt::format("<track course=\"{:.1f}\" speed=\"{:.2f}\"/>", DegreesFromRadians(motion->course_rad),
                        motion->speed_m_s);
  }
  const double ce_m = place.ce90_m / std::sqrt(2 * std::log(10.0));
  const double le_m = std::sqrt(place.covariance_enu_m2(2, 2));
  return fmt::format(
      "<event version=\"2.0\" uid=\"{}\" type=\"{}\" how=\"m-f\" time=\"{}\" start=\"{}\" stale=\"{}\">"
      "<point lat=\"{:.8f}\" lon=\"{:.8f}\" hae=\"{:.2f}\" ce=\"{:.2f}\" le=\"{:.2f}\"/>"
      "<detail><contact callsign=\"{} {}\"/>{}<remarks>{}</remarks></detail></event>\n",
      UidOf(listed.object, everything), type, FormatUtc(now_us, kUtcDecimals), FormatUtc(start_us, kUtcDecimals),
      FormatUtc(stale_us, kUtcDecimals), DegreesFromRadians(place.point.latitude_rad),
      DegreesFromRadians(place.point.longitude_rad), place.point.altitude_m, ce_m, le_m, EscapedXml(listed.model),
      listed.object.id, track, EscapedXml(RemarksOf(listed)));
}

}  // namespace

std::string_view CotTypeOf(std::string_view name) {
  std::string_view type = "a-u-G";
  std::string word;
  const auto look_up = [&] {
    const auto found = std::ranges::find(kCotWords, word, &CotWord::word);
    if (found != kCotWords.end()) type = found->type;
    word.clear();
  };
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (is_letter) {
      word += static_cast<char>(c | 0x20);  // in lower case
    } else {
      look_up();
    }
  }
  look_up();
  return type;
}

Status CheckCotType(std::string_view type) {
  const bool has_words = !type.empty() && type.front() != '-' && type.back() != '-' && !type.contains("--");
  if (has_words && std::ranges::all_of(type, [](char c) { return c == '-' || IsAsciiWord(c); })) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("type {}: is none of Cursor-on-Target: give words with - between them, as a-h-G-E-V",
                          OneLine(std::string(type))));
}

namespace {

Status WriteCot(const ExportRequest& request, std::ostream& out) {
  const ExportOptions& options = request.options;
  if (!options.cot_type.empty()) VICTORIOUS_RETURN_IF_ERROR(CheckCotType(options.cot_type));
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue everything, Catalogue::Read(request.store, {}));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  const std::int64_t now_us = options.now_utc_us.value_or(NowUtcMicroseconds());
  for (const ListedObject& object : objects) {
    if (!object.object.place) continue;
    const std::string_view type =
        options.cot_type.empty() ? CotTypeOf(object.model) : std::string_view(options.cot_type);
    out << EventText(object, everything, type, now_us);
  }
  return {};
}

}  // namespace

constinit const ExportFormat kCotFormat{
    .name = "cot",
    .file = "a list of events of Cursor-on-Target (XML)",
    .is_map = true,
    .is_file = [](std::string_view head) { return head.starts_with("<event version=\"2.0\" uid=\"victorious-"); },
    .write = &WriteCot};

}  // namespace victorious
