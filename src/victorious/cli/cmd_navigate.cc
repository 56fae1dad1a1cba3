// victorious navigate VIDEO --landmarks DB --models DIR --out FILE.csv: where the camera was, by what it saw
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/geometry/angles.h"
#include "victorious/model/model_library.h"
#include "victorious/pipeline/navigate_run.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string video;
  std::string landmarks;
  std::string models;
  std::string out;
  std::string params;
  std::optional<std::string> telemetry;
  std::optional<double> hfov_deg;
};

// What telemetry was off by in the frame in the middle of those with landmarks; a warning where that is far more than
// the sigma of its offset, `foreseen_m`, foresees.
void TellOffset(const Navigation& navigation, double foreseen_m) {
  std::vector<const NavigatedFrame*> seen;
  for (const NavigatedFrame& frame : navigation.frames) {
    if (frame.landmarks > 0 && frame.offset) seen.push_back(&frame);
  }
  if (seen.empty()) return;
  const NavigatedFrame& frame = *seen[seen.size() / 2];
  const auto sigma = [&](int i) { return std::sqrt(std::max(0.0, frame.offset->covariance(i, i))); };
  const Eigen::Vector3d& place = frame.offset->place_enu_m;
  spdlog::info("telemetry at {:.1f} s was off by {:.2f} +- {:.2f} m east, {:.2f} +- {:.2f} north, {:.2f} +- {:.2f} up",
               frame.camera.time_s, place.x(), sigma(0), place.y(), sigma(1), place.z(), sigma(2));
  const auto degrees = [&](int i) { return DegreesFromRadians(frame.offset->attitude_rad[i]); };
  const auto sigma_deg = [&](int i) { return DegreesFromRadians(sigma(3 + i)); };
  spdlog::info("and by {:.2f} +- {:.2f} deg in yaw, {:.2f} +- {:.2f} in pitch, {:.2f} +- {:.2f} in roll", degrees(0),
               sigma_deg(0), degrees(1), sigma_deg(1), degrees(2), sigma_deg(2));
  constexpr double kManySigmas = 10;
  if (place.norm() < kManySigmas * foreseen_m) return;
  spdlog::warn("telemetry is {:.0f} m from where the landmarks were seen from: it, or the landmarks, may be another's",
               place.norm());
}

void Tell(const NavigationRun& run, const NavigateOptions& options) {
  const std::vector<NavigatedFrame>& frames = run.navigation.frames;
  const auto seen = std::ranges::count_if(frames, [](const NavigatedFrame& frame) { return frame.landmarks > 0; });
  spdlog::info("{} frames, {} with a landmark; {} sightings were not believed", run.frames, seen, run.unbelieved);
  for (std::size_t i = 0; i < run.landmarks.size(); ++i) {
    if (run.sightings[i] == 0) continue;
    const Landmark& landmark = run.landmarks[i];
    spdlog::info("landmark {} at {:.6f} {:.6f}: in {} frames", landmark.model,
                 DegreesFromRadians(landmark.place.latitude_rad), DegreesFromRadians(landmark.place.longitude_rad),
                 run.sightings[i]);
  }
  TellOffset(run.navigation, options.telemetry.position_m);
  spdlog::info("{:.1f} ms a frame once landmarks are followed, {:.1f} of processor time; {:.2f} to estimate the flight",
               run.tracked_ms, run.tracked_cpu_ms, run.estimate_ms);
  if (frames.empty()) spdlog::warn("no landmark was recognised, and there is no telemetry: no place is known");
}

Status Run(const Arguments& arguments) {
  NavigateRunOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, FieldsOf(options)));
  if (arguments.hfov_deg) options.telemetry.hfov_deg = *arguments.hfov_deg;
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectModel> models, ModelLibrary(arguments.models).LoadAll());
  if (models.empty()) {
    return Fail(
        ErrorCode::kNotFound,
        fmt::format("{}: no models to recognise landmarks by; make one with `victorious model add`", arguments.models));
  }
  std::vector<std::string> warnings;  // an error stays the only line
  const NavigateJob job{.video = arguments.video, .landmarks = arguments.landmarks, .telemetry = arguments.telemetry};
  VICTORIOUS_ASSIGN_OR_RETURN(const NavigationRun run,
                              NavigateVideo(job, std::move(models), options, Interrupt(),
                                            [&](const std::string& warning) { warnings.push_back(warning); }));
  for (const std::string& warning : warnings) spdlog::warn("{}", OneLine(warning));
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments.out, ToCsv(run)));
  Tell(run, options.navigate);
  return {};
}

}  // namespace

Action SetUpNavigate(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("VIDEO", arguments->video, "A file or a folder of frames")->required();
  app.add_option("--landmarks", arguments->landmarks,
                 "Objects of known place: an index, or a list as `export --format objects` writes it")
      ->required()
      ->type_name("DB");
  app.add_option("--models", arguments->models, "The folder of the landmarks' models")->required()->type_name("DIR");
  app.add_option("--out", arguments->out, "The camera's states, CSV (docs/formats/navigate.md)")
      ->required()
      ->type_name("FILE");
  app.add_option("--telemetry", arguments->telemetry,
                 "Where the camera was said to be (unless given: the video's own KLV, NAME.SRT or NAME.telemetry.csv "
                 "beside it)")
      ->type_name("FILE");
  AddFieldOfView(app, arguments->hfov_deg);
  AddParams(app, arguments->params, "navigate");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
