#include "victorious/lab/simulate/simulate.h"

#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/progress.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/input/video/video_writer.h"
#include "victorious/lab/simulate/flight.h"
#include "victorious/lab/simulate/placed_scene.h"
#include "victorious/lab/simulate/telemetry.h"
#include "victorious/lab/simulate/truth.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

GeodeticPoint GeodeticOrigin(const SceneOrigin& origin) {
  return {RadiansFromDegrees(origin.latitude_deg), RadiansFromDegrees(origin.longitude_deg), origin.altitude_m};
}

Status MakeFolder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return std::unexpected(ErrorFromErrno(failed.value(), "make folder " + folder.string()));
  return {};
}

// The data of a frame for telemetry.csv and truth.jsonl.
struct FrameText {
  CameraState camera;
  std::string truth;  ///< its lines of truth.jsonl
};

Expected<FrameText> MakeFrameText(const Scene& scene, const RenderedFrame& drawn, int frame, Renderer& renderer) {
  const TangentPlane earth(GeodeticOrigin(scene.origin));
  const double heading = RadiansFromDegrees(scene.origin.heading_deg);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::vector<ObjectTruth> truth,
      ComputeTruth(drawn.objects, drawn.view.instances, drawn.camera, earth, heading, renderer));
  FrameText text{.camera = MakeCameraState(drawn.camera.camera_from_world, earth, heading, drawn.time_s,
                                           RadiansFromDegrees(scene.video.hfov_deg)),
                 .truth = {}};
  for (const ObjectTruth& row : truth)
    text.truth += FormatTruthLine(row, scene.objects[static_cast<std::size_t>(row.object)], frame, drawn.time_s);
  return text;
}

}  // namespace

Status Simulate(const Scene& scene, const fs::path& out, const SimulateOptions& options, const CancelToken& cancel,
                const std::function<void(const std::string&)>& warn) {
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create({.software = options.software}));
  VICTORIOUS_ASSIGN_OR_RETURN(const PlacedScene placed, PlacedScene::Build(scene, renderer, cancel, warn));
  VICTORIOUS_RETURN_IF_ERROR(MakeFolder(out));
  const SceneVideo& video = scene.video;
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto writer,
      VideoWriter::Create(out / "video.mp4",
                          {.width = video.width, .height = video.height, .fps = video.fps, .crf = video.crf}));
  Flight flight(scene, renderer, placed);
  std::vector<CameraState> cameras;
  std::string truth;
  Progress progress("simulating " + out.string(), video.frames, "frames");
  for (int frame = 0; frame < video.frames; ++frame) {
    if (cancel.IsCancelled()) {
      return Fail(ErrorCode::kCancelled,
                  fmt::format("{}: stopped at frame {} of {}, nothing is written", out.string(), frame, video.frames));
    }
    const auto draw = [&]() -> Status {
      VICTORIOUS_ASSIGN_OR_RETURN(const RenderedFrame drawn, flight.Draw(frame));
      VICTORIOUS_ASSIGN_OR_RETURN(const FrameText text, MakeFrameText(scene, drawn, frame, renderer));
      cameras.push_back(text.camera);
      truth += text.truth;
      return writer->Write(drawn.bgr);
    };
    if (Status status = draw(); !status)
      return std::unexpected(std::move(status).error().WithContext(fmt::format("frame {}", frame)));
    progress.Update(frame + 1);
  }
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(out / "telemetry.csv", FormatCameraCsv(cameras)));
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(out / "truth.jsonl", truth));
  return writer->Finish();
}

}  // namespace victorious
