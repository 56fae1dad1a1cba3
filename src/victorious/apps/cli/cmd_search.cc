// victorious search --db DB: lists objects by rank, or moments similar to an image
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/geometry/angles.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/show/search_image.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/open_store.h"
#include "victorious/store/video_coverage.h"

namespace victorious::cli {
namespace {

using nlohmann::ordered_json;

struct SearchArguments {
  std::string db;
  FilterArguments filter;
  std::string image;
  std::string box;
  std::string params;
  int most = 0;
  bool json = false;
};

std::string TimeText(double seconds) {
  const auto minutes = static_cast<int>(seconds / 60);
  return fmt::format("{}:{:05.2f}", minutes, seconds - 60.0 * minutes);
}

// "52.5201234 13.4051234 +-0.6 m", or "-".
std::string PlaceText(const ObjectRecord& object) {
  if (!object.place) return "-";
  return fmt::format("{:.6f} {:.6f} +-{:.1f} m", DegreesFromRadians(object.place->point.latitude_rad),
                     DegreesFromRadians(object.place->point.longitude_rad), object.place->ce90_m);
}

// Why the object, or its place, is rejected, and what else speaks against it; empty if nothing does.
std::string ReasonText(const ObjectRecord& object) {
  std::string text;
  if (!object.rejected.empty()) {
    text = fmt::format("  (rejected: {})", object.rejected);
  } else if (!object.place_rejected.empty()) {
    text = fmt::format("  (no place: {})", object.place_rejected);
  }
  std::vector<std::string> others = object.against;
  std::erase(others, object.place_rejected);
  if (!others.empty()) text += fmt::format("  (against: {})", fmt::join(others, "; "));
  return text;
}

std::string ObjectLine(const ListedObject& listed) {
  const ObjectRecord& object = listed.object;
  const std::optional<double> speed_m_s = ComputeSpeed(object);
  const bool are_several = listed.moments.size() > 1;  // their times have nothing in common
  std::vector<std::string> videos;
  for (const ObjectMoment& one : listed.moments) {
    videos.push_back(
        are_several ? fmt::format("{} {} to {}", one.video_name, TimeText(one.first_time_s), TimeText(one.last_time_s))
                    : one.video_name);
  }
  return fmt::format("{:>4}  {:<16} {:>6.3f} {:>7}  {:>8} {:>8}  {:>6}  {:<32} {:>7} {:>6}  {}{}\n", listed.rank,
                     listed.model, object.score, object.frames, are_several ? "-" : TimeText(object.first_time_s),
                     are_several ? "-" : TimeText(object.last_time_s), object.id, PlaceText(object),
                     object.heading_rad ? fmt::format("{:.0f}", DegreesFromRadians(*object.heading_rad)) : "-",
                     speed_m_s ? fmt::format("{:.1f}", *speed_m_s) : "-", fmt::join(videos, ", "), ReasonText(object));
}

Status PrintObjects(const SearchArguments& arguments, const SightingFilter& filter, const Catalogue& catalogue,
                    IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ListedObject> objects, ListObjects(store, catalogue, filter));
  if (arguments.most > 0) objects.resize(std::min(objects.size(), static_cast<std::size_t>(arguments.most)));
  std::string text;
  if (arguments.json) {
    for (const ListedObject& object : objects) text += DumpJson(ObjectJson(object)) + "\n";
  } else if (objects.empty()) {
    text = "nothing found\n";
  } else {
    text = fmt::format("{:>4}  {:<16} {:>6} {:>7}  {:>8} {:>8}  {:>6}  {:<32} {:>7} {:>6}  {}\n", "rank", "model",
                       "score", "frames", "from", "to", "object", "place (CE90)", "heading", "m/s", "videos");
    for (const ListedObject& object : objects) text += ObjectLine(object);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string below, ExplainScores(filter, store));
  if (!below.empty()) LogInfo(OneLine(below));
  if (objects.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string why, ExplainNothingFound(filter, store));
    if (!why.empty()) LogInfo(OneLine(why));
  }
  if (arguments.filter.rejected &&
      std::ranges::all_of(objects, [](const auto& one) { return one.object.rejected.empty(); })) {
    LogInfo("no object was rejected");
  }
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput("", text));
  if (arguments.json || objects.empty()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string rejected, ExplainRejected(filter, store));
  if (!rejected.empty()) LogInfo(rejected);
  return {};
}

Status PrintMoments(const SearchArguments& arguments, const SightingFilter& filter, IndexStore& store) {
  IndexOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  std::optional<Box> box;
  if (!arguments.box.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(box, ParseBox(arguments.box));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const Photo example, LoadPhoto(arguments.image, box));
  VICTORIOUS_ASSIGN_OR_RETURN(const ImageSearch found, SearchByImage(example, filter, options.recognize, store));
  const std::vector<VideoSegment>& moments = found.segments;
  std::string text;
  if (!arguments.json)
    text = fmt::format("{:>4}  {:>6} {:>9} {:>9} {:>9}  {:>24}  {}\n", "rank", "score", "best at", "from", "to",
                       "box x,y,w,h", "video");
  int rank = 0;
  for (const VideoSegment& moment : moments) {
    if (++rank > arguments.most && arguments.most > 0) break;
    const Box& b = moment.box;
    text += arguments.json
                ? DumpJson(ordered_json({{"rank", rank},
                                         {"video", moment.video},
                                         {"frame", moment.frame},
                                         {"time_s", moment.time_s},
                                         {"box", {b.x, b.y, b.width, b.height}},
                                         {"score", moment.score},
                                         {"matches", moment.matches},
                                         {"first_time_s", moment.first_time_s},
                                         {"last_time_s", moment.last_time_s},
                                         {"frames", moment.frames}})) +
                      "\n"
                : fmt::format("{:>4}  {:>6.3f} {:>9} {:>9} {:>9}  {:>24}  {}\n", rank, moment.score,
                              TimeText(moment.time_s), TimeText(moment.first_time_s), TimeText(moment.last_time_s),
                              fmt::format("{:.0f},{:.0f},{:.0f},{:.0f}", b.x, b.y, b.width, b.height), moment.video);
  }
  if (moments.empty() && !arguments.json) text = "nothing found\n";
  if (moments.empty()) {
    LogInfo("the object of {} is in none of the {} of {} that were searched", OneLine(arguments.image),
            CountText(found.searched_frames, "kept frame"), CountText(found.searched_videos, "video"));
  }
  return WriteOutput("", text);
}

// Warns of videos that were searched only in part or not at all: the list does not cover them.
Status WarnAboutUnfinished(const Catalogue& catalogue, IndexStore& store) {
  if (catalogue.videos().empty()) LogWarning("no matching video in this index");
  for (const VideoRecord& video : catalogue.videos()) {
    std::vector<ModelRecord> begun;
    std::vector<SearchRecord> searches;
    for (const ModelRecord& model : catalogue.models()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search, store.FindSearch(video.id, model.id));
      if (!search) continue;
      begun.push_back(model);
      searches.push_back(*search);
    }
    if (begun.empty()) {
      LogWarning("{}: not searched for the requested models: run `index` on it", video.name);
      continue;
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> parts, store.SearchParts(video.id));
    const std::vector<LeftOutTime> left_out = CoverageOf(video, begun, searches, parts).left_out;
    if (left_out.empty()) continue;
    const std::size_t others = left_out.size() - 1;
    LogWarning(
        "{}: not all of it was searched: {}{}", video.name, DescribeLeftOut(left_out.front()),
        others > 0 ? fmt::format("; and {} (`victorious doctor` lists them)", CountText(others, "other time")) : "");
  }
  return {};
}

Status Run(const SearchArguments& arguments) {
  if (!arguments.image.empty() && !(arguments.filter.model.empty() && arguments.filter.category.empty())) {
    return Fail(ErrorCode::kInvalidArgument, arguments.filter.model.empty()
                                                 ? "--image and --category exclude each other: give one of them"
                                                 : "--image and --model exclude each other: give one of them");
  }
  if (arguments.image.empty() && !(arguments.box.empty() && arguments.params.empty())) {
    return Fail(ErrorCode::kInvalidArgument, "--box and --params need --image");
  }
  if (arguments.filter.rejected && !arguments.image.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--rejected and --image exclude each other: give one of them");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments.filter.Filter());
  if (filter.thresholds == ThresholdUse::kApplied && !arguments.image.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--thresholds and --image exclude each other: give one of them");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kRead));
  VICTORIOUS_RETURN_IF_ERROR(CheckObject(filter, *store));
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(*store, filter));
  if (!arguments.image.empty()) VICTORIOUS_RETURN_IF_ERROR(PrintMoments(arguments, filter, *store));
  VICTORIOUS_RETURN_IF_ERROR(WarnAboutUnfinished(catalogue, *store));
  return arguments.image.empty() ? PrintObjects(arguments, filter, catalogue, *store) : Status();
}

}  // namespace

Action SetUpSearch(ArgumentParser& parser) {
  const auto arguments = std::make_shared<SearchArguments>();
  AddDb(parser, arguments->db);
  arguments->filter.AddTo(parser);
  parser.Add("--image", arguments->image, "Example image: list the moments that show its object").TypeName("FILE");
  parser.Add("--box", arguments->box, "The object in the example image").TypeName("X,Y,W,H");
  AddParams(parser, arguments->params, "index");
  parser.Add("--most", arguments->most, "Largest number of rows; 0: all").Range(0, 1'000'000'000).TypeName("N");
  parser.AddFlag("--json", arguments->json, "One JSON object per line");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
