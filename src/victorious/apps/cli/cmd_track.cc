// victorious track VIDEO --box X,Y,W,H --at SECONDS: tracks the objects in user boxes through videos, and enters them
// into an index
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/track/keep_boxes.h"
#include "victorious/jobs/track/track_job.h"
#include "victorious/place/observe/object_type.h"
#include "victorious/show/drawn_video.h"
#include "victorious/show/export/export_lines.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

struct TrackArguments {
  std::string video;
  std::vector<std::string> boxes;
  std::vector<double> at_s;
  std::vector<std::string> types;
  std::vector<std::string> also;
  std::string telemetry;
  std::optional<double> hfov_deg;
  CameraArguments camera;
  GroundArguments ground;
  std::string params;
  std::string out;
  std::string db;
  std::string draw;
  bool json = false;
};

// Assigns the object types: one for all boxes, or one for each.
Status SetTypes(const std::vector<std::string>& types, std::vector<UserBox>& boxes) {
  if (types.empty()) return {};
  if (types.size() != 1 && types.size() != boxes.size()) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} --type and {} --box: give one --type, or one for each --box", types.size(), boxes.size()));
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i].type = types[types.size() == 1 ? 0 : i];
  return {};
}

std::string KnownTypes() {
  std::vector<std::string_view> known;
  for (const ObjectType& one : ObjectTypes()) known.push_back(one.name);
  return fmt::format("{}", fmt::join(known, ", "));
}

// Logs the types that are not in the table of object types: they give neither a length nor a motion model.
void LogUnknownTypes(const std::vector<std::string>& types) {
  for (const std::string& type : types) {
    if (type.empty() || FindObjectType(type) != nullptr) continue;
    LogInfo("{}: not a known object type, used as a name only; sizes and motions are known for: {}", OneLine(type),
            KnownTypes());
  }
}

// Logs in which frames and videos an object was seen.
void LogSightingTimes(const std::vector<BoxSighting>& sightings, const std::vector<std::string>& videos,
                      std::size_t box_index) {
  for (std::size_t video = 0; video < videos.size(); ++video) {
    std::vector<const BoxSighting*> seen;
    for (const BoxSighting& one : sightings) {
      if (one.box_index == box_index && one.video == video) seen.push_back(&one);
    }
    if (seen.empty()) {
      LogInfo("{}: not seen in {}", BoxName(box_index), OneLine(videos[video]));
      continue;
    }
    LogInfo("{}: seen in {} of {}, {:.2f} to {:.2f} s", BoxName(box_index), CountText(seen.size(), "frame"),
            OneLine(videos[video]), seen.front()->time_s, seen.back()->time_s);
  }
}

// Logs the place of an object when it was last seen, or the reason why there is none.
void LogPlace(const TrackedBoxes& tracked, std::size_t box_index) {
  if (!tracked.place_failures[box_index].empty()) {
    LogInfo("{}: no place: {}", BoxName(box_index), tracked.place_failures[box_index]);
    return;
  }
  const auto last =
      std::ranges::find_if(tracked.sightings.rbegin(), tracked.sightings.rend(),
                           [&](const BoxSighting& one) { return one.box_index == box_index && one.place.has_value(); });
  const Geolocation& place = *last->place;
  LogInfo("{}: place at {:.2f} s: {:.6f}, {:.6f}, {:.1f} m; CE90 {:.1f} m, LE90 {:.1f} m{}", BoxName(box_index),
          last->time_s, DegreesFromRadians(place.point.latitude_rad), DegreesFromRadians(place.point.longitude_rad),
          place.point.altitude_m, place.ce90_m, place.le90_m,
          place.IsMoving() ? fmt::format("; moving at {:.1f} m/s", place.velocity_enu->norm()) : "");
}

// One JSON object per box: in how many frames of which videos it was seen, and its last place.
std::string SummaryLines(const TrackedBoxes& tracked, const std::vector<std::string>& videos,
                         const std::vector<UserBox>& boxes) {
  std::string lines;
  for (std::size_t box_index = 0; box_index < boxes.size(); ++box_index) {
    std::vector<std::size_t> frames(videos.size(), 0);
    const Geolocation* place = nullptr;
    for (const BoxSighting& one : tracked.sightings) {
      if (one.box_index != box_index) continue;
      ++frames[one.video];
      if (one.place) place = &*one.place;
    }
    nlohmann::ordered_json json = {{"model", BoxName(box_index)}, {"frames", nlohmann::ordered_json::object()}};
    for (std::size_t video = 0; video < videos.size(); ++video) json["frames"][videos[video]] = frames[video];
    json["latitude_deg"] = place ? nlohmann::ordered_json(DegreesFromRadians(place->point.latitude_rad)) : nullptr;
    json["longitude_deg"] = place ? nlohmann::ordered_json(DegreesFromRadians(place->point.longitude_rad)) : nullptr;
    json["altitude_m"] = place ? nlohmann::ordered_json(place->point.altitude_m) : nullptr;
    json["ce90_m"] = place ? nlohmann::ordered_json(place->ce90_m) : nullptr;
    json["le90_m"] = place ? nlohmann::ordered_json(place->le90_m) : nullptr;
    const std::string& failure = tracked.place_failures[box_index];
    json["no_place"] = failure.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(failure);
    lines += DumpJson(json) + "\n";
  }
  return lines;
}

// Sightings in a video that is given twice would be counted twice.
Status CheckDifferent(const std::vector<std::string>& videos) {
  std::error_code error;
  for (auto one = videos.begin(); one != videos.end(); ++one) {
    for (auto other = videos.begin(); other != one; ++other) {
      if (*one != *other && !std::filesystem::equivalent(*one, *other, error)) continue;
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: given twice: give each video once", *one));
    }
  }
  return {};
}

// The index that the boxes are entered into, with the videos in it.
struct OpenedIndex {
  std::unique_ptr<IndexStore> store;
  std::vector<VideoRecord> videos;
};

Expected<OpenedIndex> OpenIndex(const std::string& db, const std::vector<std::string>& videos) {
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_index, HasIndex(db));
  if (!has_index) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such index", StoreName(db)));
  OpenedIndex index;
  VICTORIOUS_ASSIGN_OR_RETURN(index.store, OpenStore(db, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(index.videos, FindTrackedVideos(videos, *index.store, Interrupt()));
  return index;
}

// Logs the object that a box has become, with its place or the reason why there is none.
void LogObject(const TrackedBoxes& tracked, std::size_t box_index, const UserBox& box, std::int64_t object) {
  const std::string& failure = tracked.place_failures[box_index];
  if (failure.empty()) LogPlace(tracked, box_index);
  LogInfo("{}: is object {}, {}{}", BoxName(box_index), object, OneLine(CategoryOfBox(box)),
          failure.empty() ? "" : "; no place: " + failure);
}

Status Run(const TrackArguments& arguments, const ArgumentParser& parser) {
  if (arguments.out.empty() && arguments.db.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "nowhere to put the tracks: give --out FILE, or --db INDEX, or both");
  }
  TrackBoxesOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.hfov_deg) options.telemetry.hfov_deg = *arguments.hfov_deg;
  VICTORIOUS_RETURN_IF_ERROR(ApplyCamera(arguments.camera, options.telemetry));
  ApplyGround(arguments.ground, options.ground);
  std::vector<std::string> videos = {arguments.video};
  videos.insert(videos.end(), arguments.also.begin(), arguments.also.end());
  const auto telemetry = arguments.telemetry.empty() ? std::nullopt : std::optional(arguments.telemetry);
  std::vector<std::string> read = ListTelemetryBeside(videos, telemetry);
  if (!options.ground.terrain.empty()) read.push_back(options.ground.terrain);
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(
      parser, {{"--out", arguments.out, &kSightingsFormat}, {"--draw", arguments.draw, FileKind::kVideo}}, read));
  if (!arguments.out.empty()) VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  VICTORIOUS_RETURN_IF_ERROR(CheckDrawnVideo(arguments.draw));
  if (arguments.boxes.size() != arguments.at_s.size()) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{} --box and {} --at: give one --at for each --box",
                                                         arguments.boxes.size(), arguments.at_s.size()));
  }
  std::vector<UserBox> boxes;
  for (std::size_t i = 0; i < arguments.boxes.size(); ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, ParseBox(arguments.boxes[i]));
    boxes.push_back({box, arguments.at_s[i]});
  }
  VICTORIOUS_RETURN_IF_ERROR(SetTypes(arguments.types, boxes));
  VICTORIOUS_RETURN_IF_ERROR(CheckDifferent(videos));
  OpenedIndex index;
  if (!arguments.db.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(index, OpenIndex(arguments.db, videos));
  }
  std::vector<std::string> warnings;  // collected, so that an error stays the only line
  const auto warn = [&](const std::string& warning) { warnings.push_back(warning); };
  VICTORIOUS_ASSIGN_OR_RETURN(const TrackedBoxes tracked,
                              TrackBoxes(videos, boxes, telemetry, options, Interrupt(), warn));
  for (const std::string& warning : warnings) LogWarning(OneLine(warning));
  if (!arguments.out.empty()) {
    VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments.out, ToJsonLines(tracked.sightings, videos, boxes)));
  }
  std::vector<std::int64_t> objects;
  if (index.store) {
    VICTORIOUS_ASSIGN_OR_RETURN(objects, KeepBoxes(tracked.sightings, boxes, index.videos, *index.store));
  }
  if (!arguments.draw.empty()) {
    VICTORIOUS_RETURN_IF_ERROR(DrawVideo(arguments.video, ListBoxDrawing(tracked.sightings, boxes),
                                         {.folder_frame_rate = VideoReaderOptions().folder_frame_rate}, arguments.draw,
                                         Interrupt()));
  }
  if (arguments.json) VICTORIOUS_RETURN_IF_ERROR(WriteOutput("", SummaryLines(tracked, videos, boxes)));
  LogUnknownTypes(arguments.types);
  for (std::size_t box_index = 0; box_index < boxes.size(); ++box_index) {
    LogSightingTimes(tracked.sightings, videos, box_index);
    if (objects.empty()) {
      LogPlace(tracked, box_index);
    } else {
      LogObject(tracked, box_index, boxes[box_index], objects[box_index]);
    }
  }
  return {};
}

}  // namespace

Action SetUpTrack(ArgumentParser& parser) {
  const auto arguments = std::make_shared<TrackArguments>();
  parser.Add("VIDEO", arguments->video, "A file or a folder of frames").Required();
  parser.Add("--box", arguments->boxes, "Box around an object, px; repeatable, with one --at each: box-1, box-2, ...")
      .Required()
      .TypeName("X,Y,W,H")
      .OneValueEach();
  parser.Add("--at", arguments->at_s, "Time of the box, in the first frame at this time or later: seconds, or as 1:30")
      .Required()
      .TypeName("TIME")
      .Transform(&NormalizeVideoTime)
      .OneValueEach();
  parser
      .Add("--type", arguments->types,
           "Object type in the box; it gives the usual length, from which the range follows, and whether the "
           "object may move. Known: " +
               KnownTypes() + "; any other word is only a name. One for all boxes, or one for each")
      .TypeName("WORD")
      .OneValueEach();
  parser
      .Add("--telemetry", arguments->telemetry,
           "Camera states, to geolocate the objects (default: telemetry in the video or beside it)")
      .TypeName("FILE");
  AddFieldOfView(parser, arguments->hfov_deg);
  AddCamera(parser, arguments->camera);
  AddGround(parser, arguments->ground);
  parser.Add("--also", arguments->also, "Further videos to search for the objects").TypeName("FILE");
  parser.Add("--params", arguments->params, "Parameters (`victorious params track`)").TypeName("FILE");
  parser.Add("--out", arguments->out, "Sightings, JSON Lines (docs/formats/export.md)").TypeName("FILE");
  parser
      .Add("--db", arguments->db,
           "Index of the videos, into which the objects are entered as category boxed/TYPE (boxed/object): then they "
           "are listed, reviewed and exported as what a search finds. Give this, --out, or both")
      .TypeName("INDEX");
  parser
      .Add("--draw", arguments->draw,
           "Write a copy of VIDEO with the boxes, names and places drawn into it (.mp4, .mkv)")
      .TypeName("FILE");
  parser.AddFlag("--json", arguments->json, "Print one JSON object per box: frames per video, last place");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
