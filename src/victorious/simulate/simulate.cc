#include "victorious/simulate/simulate.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/progress.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/simulate/degrade.h"
#include "victorious/simulate/flight_path.h"
#include "victorious/simulate/stage.h"
#include "victorious/simulate/telemetry.h"
#include "victorious/simulate/truth.h"
#include "victorious/telemetry/camera_csv.h"
#include "victorious/video/video_writer.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Purposes of the scene's seed: each draws from its own stream.
enum SeedUse : std::uint64_t { kShakeSeed = 0x5A01, kNoiseSeed = 0x5A02 };

Light LightOf(const Scene& scene) {
  const double azimuth = RadiansFromDegrees(scene.sun.azimuth_deg - scene.origin.heading_deg);
  const double elevation = RadiansFromDegrees(scene.sun.elevation_deg);
  Light light;
  light.sky = scene.sun.sky;
  light.ground = scene.sun.ground;
  light.sun = scene.sun.strength;
  light.shadows = true;
  light.to_sun_in_world = {std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
                           std::sin(elevation)};
  return light;
}

GeodeticPoint PlaceOf(const SceneOrigin& origin) {
  return {RadiansFromDegrees(origin.latitude_deg), RadiansFromDegrees(origin.longitude_deg), origin.altitude_m};
}

Status MakeFolder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return std::unexpected(ErrorFromErrno(failed.value(), "make folder " + folder.string()));
  return {};
}

struct FrameResult {
  cv::Mat bgr;
  CameraState camera;
  std::string truth;  ///< its lines
};

class Flight {
 public:
  Flight(const Scene& scene, Renderer& renderer, const Stage& stage)
      : scene_(scene), renderer_(renderer), stage_(stage), light_(LightOf(scene)), earth_(PlaceOf(scene.origin)) {}

  Expected<FrameResult> Draw(int frame) {
    const SceneVideo& video = scene_.video;
    const double time_s = frame / video.fps;
    const double fraction = video.frames > 1 ? static_cast<double>(frame) / (video.frames - 1) : 0.0;
    const double heading = RadiansFromDegrees(scene_.origin.heading_deg);
    const PosedCamera camera{PinholeOf(video),
                             CameraFromTown(scene_.camera, fraction, time_s, MixSeed(scene_.seed, kShakeSeed))};
    const std::vector<StagedThing> objects = stage_.ObjectsAt(time_s);
    VICTORIOUS_ASSIGN_OR_RETURN(const RenderedView view, renderer_.Render(Instances(objects, camera), camera, light_,
                                                                          {.supersampling = video.supersampling}));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectTruth> truth,
                                TruthOf(objects, view.instances, camera, earth_, heading, renderer_));
    FrameResult result{
        .bgr = view.bgr,
        .camera = CameraStateOf(camera.camera_from_world, earth_, heading, time_s, RadiansFromDegrees(video.hfov_deg)),
        .truth = {}};
    for (const ObjectTruth& row : truth) {
      result.truth += TruthLine(row, scene_.objects[static_cast<std::size_t>(row.object)], frame, time_s);
    }
    Degrade({.blur_px = video.blur_px, .grain = video.grain, .noise = video.noise},
            MixSeed(MixSeed(scene_.seed, kNoiseSeed), static_cast<std::uint64_t>(frame)), result.bgr);
    return result;
  }

 private:
  // Objects first, so that an instance's number below theirs is the object's.
  [[nodiscard]] std::vector<MeshInstance> Instances(const std::vector<StagedThing>& objects,
                                                    const PosedCamera& camera) const {
    std::vector<MeshInstance> instances(objects.size());
    std::ranges::transform(objects, instances.begin(), [](const StagedThing& object) {
      return MeshInstance{.mesh = object.mesh.id, .world_from_mesh = object.town_from_mesh};
    });
    const std::vector<MeshInstance> town = stage_.TownSeenFrom(camera, light_.to_sun_in_world);
    instances.insert(instances.end(), town.begin(), town.end());
    return instances;
  }

  const Scene& scene_;
  Renderer& renderer_;
  const Stage& stage_;
  Light light_;
  TangentPlane earth_;
};

}  // namespace

Status Simulate(const Scene& scene, const fs::path& out, const SimulateOptions& options, const CancelToken& cancel,
                const std::function<void(const std::string&)>& warn) {
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create({.software = options.software}));
  VICTORIOUS_ASSIGN_OR_RETURN(const Stage stage, Stage::Build(scene, renderer, cancel, warn));
  VICTORIOUS_RETURN_IF_ERROR(MakeFolder(out));
  const SceneVideo& video = scene.video;
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto writer,
      VideoWriter::Create(out / "video.mp4",
                          {.width = video.width, .height = video.height, .fps = video.fps, .crf = video.crf}));
  Flight flight(scene, renderer, stage);
  std::vector<CameraState> cameras;
  std::string truth;
  Progress progress("simulating " + out.string(), video.frames, "frames");
  for (int frame = 0; frame < video.frames; ++frame) {
    if (cancel.IsCancelled()) {
      return Fail(ErrorCode::kCancelled,
                  fmt::format("{}: stopped at frame {} of {}, nothing is written", out.string(), frame, video.frames));
    }
    Expected<FrameResult> drawn = flight.Draw(frame);
    if (!drawn) return std::unexpected(std::move(drawn).error().WithContext(fmt::format("frame {}", frame)));
    cameras.push_back(drawn->camera);
    truth += drawn->truth;
    VICTORIOUS_RETURN_IF_ERROR(writer->Write(drawn->bgr));
    progress.Update(frame + 1);
  }
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(out / "telemetry.csv", CameraCsvText(cameras)));
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(out / "truth.jsonl", truth));
  return writer->Finish();
}

}  // namespace victorious
