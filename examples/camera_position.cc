// camera_position TELEMETRY TIME_S: reads a telemetry file (KLV, DJI subtitles or a table) and prints where the camera
// is at a time of the video, interpolated between the recorded states, and where it looks.
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "victorious/base/error.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {
namespace {

Status PrintCamera(const std::string& file, double time_s) {
  const TelemetryOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(file));
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, ParseTelemetry(bytes, options));
  for (const std::string& warning : telemetry.warnings) fmt::print(stderr, "{}: {}\n", file, warning);

  const CameraTrajectory trajectory(telemetry.states, options.max_gap_s);
  const std::optional<CameraState> state = trajectory.At(time_s);
  if (!state) return Fail(ErrorCode::kNotFound, fmt::format("{}: no camera state at {} s", file, time_s));
  fmt::print("latitude {:.7f}, longitude {:.7f}, altitude {:.2f} m\n", DegreesFromRadians(state->place.latitude_rad),
             DegreesFromRadians(state->place.longitude_rad), state->place.altitude_m);
  if (state->attitude) {
    fmt::print("yaw {:.2f}, pitch {:.2f} degrees\n", DegreesFromRadians(state->attitude->yaw_rad),
               DegreesFromRadians(state->attitude->pitch_rad));
  }
  return {};
}

}  // namespace
}  // namespace victorious

int main(int argc, char** argv) {
  char* end = nullptr;
  const double time_s = argc == 3 ? std::strtod(argv[2], &end) : 0;
  if (argc != 3 || end == argv[2] || *end != '\0') {
    fmt::print(stderr, "usage: camera_position TELEMETRY TIME_S\n");
    return 2;
  }
  if (const victorious::Status printed = victorious::PrintCamera(argv[1], time_s); !printed) {
    fmt::print(stderr, "camera_position: {}\n", printed.error().message);
    return victorious::ExitStatus(printed.error().code);
  }
  return 0;
}
