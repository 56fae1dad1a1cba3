// victorious track VIDEO --box X,Y,W,H --at SECONDS: what a person drew a box around, wherever it is
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
#include <spdlog/spdlog.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/geometry/angles.h"
#include "victorious/pipeline/object_type.h"
#include "victorious/pipeline/track_run.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string video;
  std::vector<std::string> boxes;
  std::vector<double> at_s;
  std::vector<std::string> types;
  std::vector<std::string> also;
  std::string telemetry;
  std::optional<double> hfov_deg;
  GroundArguments ground;
  std::string params;
  std::string out;
};

// One type for all boxes, or one for each.
Status SetTypes(const std::vector<std::string>& types, std::vector<DrawnBox>& boxes) {
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

// A word that no place follows from is said to be one.
void TellOfNames(const std::vector<std::string>& types) {
  for (const std::string& type : types) {
    if (type.empty() || FindObjectType(type) != nullptr) continue;
    spdlog::info("{}: a name only; sizes and motions are known of: {}", OneLine(type), KnownTypes());
  }
}

// When an object was seen, in which videos.
void TellWhen(const std::vector<BoxSighting>& sightings, const std::vector<std::string>& videos, std::size_t drawn) {
  for (std::size_t video = 0; video < videos.size(); ++video) {
    std::vector<const BoxSighting*> seen;
    for (const BoxSighting& one : sightings) {
      if (one.drawn == drawn && one.video == video) seen.push_back(&one);
    }
    if (seen.empty()) {
      spdlog::info("{}: not seen in {}", BoxName(drawn), OneLine(videos[video]));
      continue;
    }
    spdlog::info("{}: seen in {} frames of {}, {:.2f} to {:.2f} s", BoxName(drawn), seen.size(), OneLine(videos[video]),
                 seen.front()->time_s, seen.back()->time_s);
  }
}

// Where an object is, when it was seen last; or why that is not told.
void TellPlace(const TrackedBoxes& tracked, std::size_t drawn) {
  if (!tracked.why_no_place[drawn].empty()) {
    spdlog::info("{}: no place is told: {}", BoxName(drawn), tracked.why_no_place[drawn]);
    return;
  }
  const auto last =
      std::ranges::find_if(tracked.sightings.rbegin(), tracked.sightings.rend(),
                           [&](const BoxSighting& one) { return one.drawn == drawn && one.place.has_value(); });
  const Place& place = *last->place;
  spdlog::info("{}: at {:.2f} s at {:.6f}, {:.6f}, {:.1f} m; CE90 {:.1f} m, LE90 {:.1f} m{}", BoxName(drawn),
               last->time_s, DegreesFromRadians(place.point.latitude_rad),
               DegreesFromRadians(place.point.longitude_rad), place.point.altitude_m, place.ce90_m, place.le90_m,
               place.Moves() ? fmt::format("; it moves at {:.1f} m/s", place.velocity_enu->norm()) : "");
}

// What is seen in a video that is given twice would count twice.
Status CheckDifferent(const std::vector<std::string>& videos) {
  std::error_code error;
  for (auto one = videos.begin(); one != videos.end(); ++one) {
    for (auto other = videos.begin(); other != one; ++other) {
      if (*one != *other && !std::filesystem::equivalent(*one, *other, error)) continue;
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: is given twice: give it once", *one));
    }
  }
  return {};
}

Status Run(const Arguments& arguments) {
  TrackRunOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, FieldsOf(options)));
  if (arguments.hfov_deg) options.telemetry.hfov_deg = *arguments.hfov_deg;
  ApplyGround(arguments.ground, options.ground);
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  if (arguments.boxes.size() != arguments.at_s.size()) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{} --box and {} --at: give one --at for each --box",
                                                         arguments.boxes.size(), arguments.at_s.size()));
  }
  std::vector<DrawnBox> boxes;
  for (std::size_t i = 0; i < arguments.boxes.size(); ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, ParseBox(arguments.boxes[i]));
    boxes.push_back({box, arguments.at_s[i]});
  }
  VICTORIOUS_RETURN_IF_ERROR(SetTypes(arguments.types, boxes));
  std::vector<std::string> videos = {arguments.video};
  videos.insert(videos.end(), arguments.also.begin(), arguments.also.end());
  VICTORIOUS_RETURN_IF_ERROR(CheckDifferent(videos));
  std::vector<std::string> warnings;  // an error stays the only line
  const auto warn = [&](const std::string& warning) { warnings.push_back(warning); };
  const auto telemetry = arguments.telemetry.empty() ? std::nullopt : std::optional(arguments.telemetry);
  VICTORIOUS_ASSIGN_OR_RETURN(const TrackedBoxes tracked,
                              TrackBoxes(videos, boxes, telemetry, options, Interrupt(), warn));
  for (const std::string& warning : warnings) spdlog::warn("{}", OneLine(warning));
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments.out, ToJsonLines(tracked.sightings, videos, boxes)));
  TellOfNames(arguments.types);
  for (std::size_t drawn = 0; drawn < boxes.size(); ++drawn) {
    TellWhen(tracked.sightings, videos, drawn);
    TellPlace(tracked, drawn);
  }
  return {};
}

}  // namespace

Action SetUpTrack(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("VIDEO", arguments->video, "A file or a folder of frames")->required();
  app.add_option("--box", arguments->boxes, "Around an object, px; repeatable, with one --at each: box-1, box-2, ...")
      ->required()
      ->type_name("X,Y,W,H")
      ->allow_extra_args(false);
  app.add_option("--at", arguments->at_s, "The box is in the first frame at this time or later: seconds, or as 1:30")
      ->required()
      ->type_name("TIME")
      ->transform(TimeOfVideo())
      ->allow_extra_args(false);
  app.add_option("--type", arguments->types,
                 "What is in the box: its usual length tells how far off it is, and whether it may move. Known are " +
                     KnownTypes() + "; any other word is a name. One for all boxes, or one for each")
      ->type_name("WORD")
      ->allow_extra_args(false);
  app.add_option("--telemetry", arguments->telemetry,
                 "The camera's states, for a place on Earth; without it, what is in the video or beside it")
      ->type_name("FILE");
  AddFieldOfView(app, arguments->hfov_deg);
  AddGround(app, arguments->ground);
  app.add_option("--also", arguments->also, "Other videos to look for the objects in");
  app.add_option("--params", arguments->params, "Parameters (`victorious params track`)")->type_name("FILE");
  app.add_option("--out", arguments->out, "Sightings, JSON Lines (docs/formats/export.md)")
      ->required()
      ->type_name("FILE");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
