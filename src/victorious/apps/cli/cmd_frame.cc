// victorious frame VIDEO --at TIME --out PNG [--json]: writes one frame as an image, to cut an object out
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/pixel_grid.h"
#include "victorious/input/video/video_reader.h"

namespace victorious::cli {
namespace {

struct FrameArguments {
  std::string video;
  std::optional<double> at_s;
  std::optional<std::int64_t> number;
  bool grid = false;
  std::string out;
  bool json = false;
};

Status WriteFrame(const FrameArguments& arguments, Frame& frame) {
  if (arguments.grid) DrawPixelGrid(frame.image);
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments.out, frame.image));
  if (!arguments.json) return {};
  const nlohmann::ordered_json line = {{"video", arguments.video},  {"image", arguments.out},
                                       {"frame", frame.index},      {"time_s", frame.time_s},
                                       {"width", frame.image.cols}, {"height", frame.image.rows}};
  return WriteOutput("", DumpJson(line) + "\n");
}

Status Run(const FrameArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments.out, FileKind::kImage}}));
  if (arguments.at_s.has_value() == arguments.number.has_value()) {
    return Fail(ErrorCode::kInvalidArgument, "give either --at or --number");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(arguments.video, {.color = FrameColor::kBgr}));
  std::optional<Frame> last;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    const bool reached = arguments.at_s ? frame->time_s >= *arguments.at_s - 1e-6 : frame->index >= *arguments.number;
    if (reached) return WriteFrame(arguments, *frame);
    last = std::move(frame);
  }
  const std::string why = reader->warnings().empty() ? "" : fmt::format(" ({})", reader->warnings().back());
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: ends with frame {} at {:.3f} s{}, before the requested frame", arguments.video,
                          last ? last->index : -1, last ? last->time_s : 0.0, why));
}

}  // namespace

Action SetUpFrame(ArgumentParser& parser) {
  const auto arguments = std::make_shared<FrameArguments>();
  parser.Add("VIDEO", arguments->video, "A file or a folder of frames").Required();
  parser.Add("--at", arguments->at_s, "First frame at this time or later: seconds, or as 1:30 or 1:02:03.5")
      .TypeName("TIME")
      .Transform(&NormalizeVideoTime);
  parser.Add("--number", arguments->number, "Frame number, from 0").TypeName("N").AtLeast(0);
  parser.AddFlag("--grid", arguments->grid, "Draw a grid of pixel coordinates, to read off the X,Y,W,H of a box");
  parser.Add("--out", arguments->out, "The output image (.png, .jpg)").Required().TypeName("FILE");
  parser.AddFlag("--json", arguments->json, "Print one JSON object: the frame written, its number and time");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
