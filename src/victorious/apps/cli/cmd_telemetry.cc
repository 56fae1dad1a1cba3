// victorious telemetry FILE [--video FILE --estimate-offset] [--out FILE.csv] [--json]
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/telemetry/telemetry_report.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious::cli {
namespace {

struct TelemetryArguments {
  std::string file;
  std::string video;
  std::string out;
  std::string params;
  std::optional<double> hfov_deg;
  CameraArguments camera;
  bool estimate_offset = false;
  bool json = false;
};

nlohmann::json ToJson(const TimeOffset& offset, double before_s) {
  return {{"time_offset_s", offset.offset_s ? nlohmann::json(before_s + *offset.offset_s) : nlohmann::json()},
          {"sigma_s", offset.offset_s ? nlohmann::json(offset.sigma_s) : nlohmann::json()},
          {"explained", offset.explained},
          {"pairs", offset.pairs},
          {"status", DescribeStatus(offset)}};
}

// Reads telemetry from a file, from the video, or from a file beside the video.
Expected<Telemetry> Read(const TelemetryArguments& arguments, const TelemetryOptions& options) {
  if (!arguments.file.empty()) return ReadTelemetry(arguments.file, options);
  VICTORIOUS_ASSIGN_OR_RETURN(
      std::optional<Telemetry> telemetry,
      FindTelemetry(arguments.video, options, [](const std::string& line) { LogWarning(OneLine(line)); }));
  if (!telemetry) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no telemetry in the video or beside it: give the telemetry file", arguments.video));
  }
  return *std::move(telemetry);
}

// Prints the time offset to standard output, and writes the corrected table to --out.
Status RunEstimate(const TelemetryArguments& arguments, const TimedTelemetryOptions& parameters, Telemetry telemetry) {
  const std::string& video = arguments.video.empty() ? arguments.file : arguments.video;
  if (arguments.video.empty() && IsTelemetryFile(arguments.file)) {
    return Fail(ErrorCode::kInvalidArgument, "--estimate-offset: needs the video as well: give --video");
  }
  if (telemetry.states.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--estimate-offset: the telemetry contains no camera state");
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  VICTORIOUS_ASSIGN_OR_RETURN(const ImageMotions image_motions,
                              MeasureMotions(video, parameters.offset, parameters.impulse_fraction, Interrupt()));
  const CameraTrajectory cameras(telemetry.states, parameters.telemetry.max_gap_s);
  const TimeOffset offset = EstimateTimeOffset(image_motions, cameras, parameters.offset);
  if (!arguments.out.empty()) {
    if (!offset.offset_s) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: nothing to write: {}", video, Describe(offset)));
    }
    for (CameraState& state : telemetry.states) state.time_s += *offset.offset_s;
    VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments.out, FormatCameraCsv(telemetry.states)));
  }
  return WriteOutput("", arguments.json ? DumpJson(ToJson(offset, parameters.telemetry.time_offset_s), 1) + "\n"
                                        : Describe(offset) + "\n");
}

Status Run(const TelemetryArguments& arguments, const ArgumentParser& parser) {
  const FileKind kind =
      arguments.json && !arguments.estimate_offset ? FileKind::kTelemetryReport : FileKind::kCameraTable;
  std::vector<std::string> beside;
  if (arguments.file.empty()) beside = ListTelemetryBeside({arguments.video}, std::nullopt);
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments.out, kind}}, beside));
  TimedTelemetryOptions parameters;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, parameters));
  if (arguments.hfov_deg) parameters.telemetry.hfov_deg = *arguments.hfov_deg;
  VICTORIOUS_RETURN_IF_ERROR(ApplyCamera(arguments.camera, parameters.telemetry));
  if (arguments.file.empty() && arguments.video.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "neither FILE nor --video given: name the source of the telemetry");
  }
  if (!arguments.file.empty() && !arguments.video.empty() && !arguments.estimate_offset) {
    return Fail(ErrorCode::kInvalidArgument, "--video together with FILE: only for --estimate-offset");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry, Read(arguments, parameters.telemetry));
  const std::string& source = arguments.file.empty() ? arguments.video : arguments.file;
  for (const std::string& warning : telemetry.warnings) LogWarning(OneLine(source + ": " + warning));
  if (arguments.estimate_offset) return RunEstimate(arguments, parameters, std::move(telemetry));
  return WriteOutput(arguments.out, arguments.json ? DumpJson(victorious::ToJson(telemetry), 1) + "\n"
                                                   : FormatCameraCsv(telemetry.states));
}

}  // namespace

Action SetUpTelemetry(ArgumentParser& parser) {
  const auto arguments = std::make_shared<TelemetryArguments>();
  parser.Add("FILE", arguments->file, "A video, KLV, the .SRT of a DJI aircraft, or a table (CSV)");
  parser.Add("--video", arguments->video, "The video of the telemetry; without FILE, the video's own telemetry is read")
      .TypeName("FILE");
  parser.AddFlag("--estimate-offset", arguments->estimate_offset,
                 "Estimate the offset between the telemetry clock and the video clock from image motion; --out writes "
                 "the corrected table");
  parser.Add("--out", arguments->out, "Output file (default: standard output)").TypeName("FILE");
  AddFieldOfView(parser, arguments->hfov_deg);
  AddCamera(parser, arguments->camera);
  parser.Add("--params", arguments->params, "Parameters as JSON (`victorious params telemetry`)").TypeName("FILE");
  parser.AddFlag("--json", arguments->json, "Print every decoded item, checksum and time stamp as JSON");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
