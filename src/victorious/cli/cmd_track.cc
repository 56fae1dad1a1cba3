// victorious track VIDEO --box X,Y,W,H --at SECONDS: what a person drew a box around, wherever it is
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/pipeline/track_run.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string video;
  std::vector<std::string> boxes;
  std::vector<double> at_s;
  std::vector<std::string> also;
  std::string params;
  std::string out;
};

Status Run(const Arguments& arguments) {
  TrackRunOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, FieldsOf(options)));
  if (arguments.boxes.size() != arguments.at_s.size()) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{} --box and {} --at: give one --at for each --box",
                                                         arguments.boxes.size(), arguments.at_s.size()));
  }
  std::vector<DrawnBox> boxes;
  for (std::size_t i = 0; i < arguments.boxes.size(); ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, ParseBox(arguments.boxes[i]));
    boxes.push_back({box, arguments.at_s[i]});
  }
  std::vector<std::string> videos = {arguments.video};
  videos.insert(videos.end(), arguments.also.begin(), arguments.also.end());
  std::vector<std::string> warnings;  // an error stays the only line
  const auto warn = [&](const std::string& warning) { warnings.push_back(warning); };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<BoxSighting> sightings,
                              TrackBoxes(videos, boxes, options, Interrupt(), warn));
  for (const std::string& warning : warnings) spdlog::warn("{}", OneLine(warning));
  return WriteOutput(arguments.out, ToJsonLines(sightings, videos));
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
  app.add_option("--also", arguments->also, "Other videos to look for the objects in");
  app.add_option("--params", arguments->params, "Parameters (`victorious params track`)")->type_name("FILE");
  app.add_option("--out", arguments->out, "Sightings, JSON Lines (docs/formats/export.md)")
      ->required()
      ->type_name("FILE");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
