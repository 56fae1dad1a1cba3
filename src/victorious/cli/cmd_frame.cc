// victorious frame VIDEO --at TIME --out PNG: writes one frame as an image, to cut an object out
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/output_files.h"
#include "victorious/image/image_file.h"
#include "victorious/image/pixel_grid.h"
#include "victorious/video/video_reader.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string video;
  std::optional<double> at_s;
  std::optional<std::int64_t> number;
  bool grid = false;
  std::string out;
};

Status Run(const Arguments& arguments, const CLI::App& app) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(app, {{"--out", arguments.out, FileKind::kImage}}));
  if (arguments.at_s.has_value() == arguments.number.has_value()) {
    return Fail(ErrorCode::kInvalidArgument, "give either --at or --number");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(arguments.video, {.color = FrameColor::kBgr}));
  std::optional<Frame> last;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    const bool reached = arguments.at_s ? frame->time_s >= *arguments.at_s - 1e-6 : frame->index >= *arguments.number;
    if (reached) {
      if (arguments.grid) DrawPixelGrid(frame->image);
      return WriteImage(arguments.out, frame->image);
    }
    last = std::move(frame);
  }
  const std::string why = reader->warnings().empty() ? "" : fmt::format(" ({})", reader->warnings().back());
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: ends with frame {} at {:.3f} s{}, before the requested frame", arguments.video,
                          last ? last->index : -1, last ? last->time_s : 0.0, why));
}

}  // namespace

Action SetUpFrame(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("VIDEO", arguments->video, "A file or a folder of frames")->required();
  app.add_option("--at", arguments->at_s, "First frame at this time or later: seconds, or as 1:30 or 1:02:03.5")
      ->type_name("TIME")
      ->transform(VideoTimeTransform());
  app.add_option("--number", arguments->number, "Frame number, from 0")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()));
  app.add_flag("--grid", arguments->grid, "Draw a grid of pixel coordinates, to read off the X,Y,W,H of a box");
  app.add_option("--out", arguments->out, "The output image (.png, .jpg)")->required()->type_name("FILE");
  AddForce(app);
  return [=, &app] { return Run(*arguments, app); };
}

}  // namespace victorious::cli
