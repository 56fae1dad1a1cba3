// victorious navigate VIDEO --landmarks DB --models DIR --out FILE.csv [--json]: estimates the camera pose from
// landmarks
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/geometry/angles.h"
#include "victorious/jobs/navigate/navigate_job.h"
#include "victorious/object/model/model_library.h"

namespace victorious::cli {
namespace {

struct NavigateArguments {
  std::string video;
  std::string landmarks;
  std::string models;
  std::string out;
  std::string params;
  std::optional<std::string> telemetry;
  std::optional<double> hfov_deg;
  CameraArguments camera;
  bool json = false;
};

std::int64_t CountFramesWithLandmark(const NavigationResult& result) {
  return std::ranges::count_if(result.navigation.frames,
                               [](const NavigatedFrame& frame) { return frame.landmarks > 0; });
}

nlohmann::ordered_json ToJson(const NavigateArguments& arguments, const NavigationResult& result) {
  nlohmann::ordered_json landmarks = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < result.landmarks.size(); ++i) {
    const Landmark& landmark = result.landmarks[i];
    landmarks.push_back({{"model", landmark.model},
                         {"latitude_deg", DegreesFromRadians(landmark.place.latitude_rad)},
                         {"longitude_deg", DegreesFromRadians(landmark.place.longitude_rad)},
                         {"frames", result.sightings[i]}});
  }
  return {{"video", arguments.video},
          {"out", arguments.out},
          {"status", ToText(kNavigationStatusTexts, result.navigation.status)},
          {"frames", result.frames},
          {"frames_with_landmark", CountFramesWithLandmark(result)},
          {"frames_located", result.states.size()},
          {"rejected_sightings", result.rejected_sightings},
          {"landmarks", std::move(landmarks)}};
}

// Logs the estimated telemetry error of the middle frame among those with landmarks. Warns if it exceeds 10 times
// `expected_sigma_m`, the standard deviation of the modelled position offset.
void LogTelemetryError(const Navigation& navigation, double expected_sigma_m) {
  std::vector<const NavigatedFrame*> with_landmark;
  for (const NavigatedFrame& frame : navigation.frames) {
    if (frame.landmarks > 0 && frame.offset) with_landmark.push_back(&frame);
  }
  if (with_landmark.empty()) return;
  const NavigatedFrame& frame = *with_landmark[with_landmark.size() / 2];
  const auto sigma = [&](int i) { return std::sqrt(std::max(0.0, frame.offset->covariance(i, i))); };
  const Eigen::Vector3d& place = frame.offset->place_enu_m;
  LogInfo("telemetry error at {:.1f} s: {:.2f} +- {:.2f} m east, {:.2f} +- {:.2f} north, {:.2f} +- {:.2f} up",
          frame.camera.time_s, place.x(), sigma(0), place.y(), sigma(1), place.z(), sigma(2));
  const auto degrees = [&](int i) { return DegreesFromRadians(frame.offset->attitude_rad[i]); };
  const auto sigma_deg = [&](int i) { return DegreesFromRadians(sigma(3 + i)); };
  LogInfo("attitude error: {:.2f} +- {:.2f} deg yaw, {:.2f} +- {:.2f} pitch, {:.2f} +- {:.2f} roll", degrees(0),
          sigma_deg(0), degrees(1), sigma_deg(1), degrees(2), sigma_deg(2));
  constexpr double kMaxSigmas = 10;
  if (place.norm() < kMaxSigmas * expected_sigma_m) return;
  LogWarning(
      "telemetry is {:.0f} m from the position estimated from landmarks: telemetry or landmarks may be of another "
      "flight",
      place.norm());
}

void LogSummary(const NavigationResult& result, const NavigateOptions& options) {
  LogInfo("{}, {} with a landmark; {} rejected as outliers", CountText(result.frames, "frame"),
          CountFramesWithLandmark(result), CountText(result.rejected_sightings, "sighting"));
  for (std::size_t i = 0; i < result.landmarks.size(); ++i) {
    if (result.sightings[i] == 0) continue;
    const Landmark& landmark = result.landmarks[i];
    LogInfo("landmark {} at {:.6f} {:.6f}: in {}", landmark.model, DegreesFromRadians(landmark.place.latitude_rad),
            DegreesFromRadians(landmark.place.longitude_rad), CountText(result.sightings[i], "frame"));
  }
  LogTelemetryError(result.navigation, options.telemetry.position_m);
  LogInfo(
      "{:.1f} ms per frame while landmarks are tracked, {:.1f} ms of CPU time; {:.2f} ms to estimate the trajectory",
      result.tracked_ms, result.tracked_cpu_ms, result.estimate_ms);
  if (result.navigation.status != NavigationStatus::kOk) {
    LogWarning("{}: the camera position is unknown", ToText(kNavigationStatusTexts, result.navigation.status));
  }
}

Status Run(const NavigateArguments& arguments, const ArgumentParser& parser) {
  NavigateVideoOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.hfov_deg) options.telemetry.hfov_deg = *arguments.hfov_deg;
  const std::vector<std::string> beside = ListTelemetryBeside({arguments.video}, arguments.telemetry);
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments.out, FileKind::kCameraTable}}, beside));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  VICTORIOUS_RETURN_IF_ERROR(ApplyCamera(arguments.camera, options.telemetry));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectModel> models, ModelLibrary(arguments.models).LoadAll());
  if (models.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: no landmark models; make one with `victorious model add`", arguments.models));
  }
  std::vector<std::string> warnings;  // collected, so that an error stays the only line
  const NavigateJob job{.video = arguments.video, .landmarks = arguments.landmarks, .telemetry = arguments.telemetry};
  VICTORIOUS_ASSIGN_OR_RETURN(const NavigationResult result,
                              NavigateVideo(job, std::move(models), options, Interrupt(),
                                            [&](const std::string& warning) { warnings.push_back(warning); }));
  for (const std::string& warning : warnings) LogWarning(OneLine(warning));
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments.out, ToCsv(result)));
  LogSummary(result, options.navigate);
  if (!arguments.json) return {};
  return WriteOutput("", DumpJson(ToJson(arguments, result)) + "\n");
}

}  // namespace

Action SetUpNavigate(ArgumentParser& parser) {
  const auto arguments = std::make_shared<NavigateArguments>();
  parser.Add("VIDEO", arguments->video, "A file or a folder of frames").Required();
  parser
      .Add("--landmarks", arguments->landmarks,
           "Objects of known place: an index (a file, or postgresql://USER@HOST/DATABASE), or a list "
           "written by `export --format objects`")
      .Required()
      .TypeName("DB");
  parser.Add("--models", arguments->models, "Folder of the landmarks' models").Required().TypeName("DIR");
  parser.Add("--out", arguments->out, "The estimated camera states, CSV (docs/formats/navigate.md)")
      .Required()
      .TypeName("FILE");
  parser
      .Add("--telemetry", arguments->telemetry,
           "Prior camera states (default: the video's own KLV, or NAME.SRT or NAME.telemetry.csv beside it)")
      .TypeName("FILE");
  AddFieldOfView(parser, arguments->hfov_deg);
  AddCamera(parser, arguments->camera);
  AddParams(parser, arguments->params, "navigate");
  parser.AddFlag("--json", arguments->json, "Print one JSON object: frames, landmarks, status");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
