#include "experiments/known_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "experiments/video_frames.h"
#include "victorious/base/file.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/lab/evaluate/truth.h"
#include "victorious/lab/simulate/flight.h"
#include "victorious/lab/simulate/truth.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {

const LabelledObject* AnnotatedImage::Find(std::string_view model) const {
  const auto found = std::ranges::find(objects, model, &LabelledObject::model);
  return found == objects.end() ? nullptr : &*found;
}

ImageDegradation DegradationOf(const Scene& scene) {
  constexpr int kQuality = 75;
  return {.degrade = {.blur_px = scene.video.blur_px, .grain = scene.video.grain, .noise = scene.video.noise},
          .jpeg_quality = kQuality};
}

SceneRenderer::SceneRenderer(std::string name, Scene scene, PlacedScene placed, Renderer& renderer)
    : name_(std::move(name)), scene_(std::move(scene)), placed_(std::move(placed)), renderer_(&renderer) {}

Expected<SceneRenderer> SceneRenderer::Load(const std::filesystem::path& scene_file, Renderer& renderer,
                                            const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(Scene scene, ReadScene(scene_file));
  VICTORIOUS_ASSIGN_OR_RETURN(PlacedScene placed,
                              PlacedScene::Build(scene, renderer, cancel, [](const std::string&) {}));
  return SceneRenderer(scene_file.stem().string(), std::move(scene), std::move(placed), renderer);
}

Expected<AnnotatedImage> SceneRenderer::Draw(const Scene& scene, int frame, const ImageDegradation& degradation) const {
  Scene clean = scene;
  clean.video.blur_px = clean.video.grain = clean.video.noise = 0;
  Flight flight(clean, *renderer_, placed_);
  VICTORIOUS_ASSIGN_OR_RETURN(RenderedFrame drawn, flight.Draw(frame));
  const GeodeticPoint origin{RadiansFromDegrees(scene.origin.latitude_deg),
                             RadiansFromDegrees(scene.origin.longitude_deg), scene.origin.altitude_m};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectTruth> truth,
                              ComputeTruth(drawn.objects, drawn.view.instances, drawn.camera, TangentPlane(origin),
                                           RadiansFromDegrees(scene.origin.heading_deg), *renderer_));
  AnnotatedImage known{.name = fmt::format("{}, frame {}", name_, frame),
                       .bgr = std::move(drawn.bgr),
                       .pinhole = drawn.camera.pinhole,
                       .depth_m = std::move(drawn.view.depth_m),
                       .objects = {}};
  for (const ObjectTruth& row : truth) {
    const auto object = static_cast<std::size_t>(row.object);
    known.objects.push_back({.model = scene.objects[object].model,
                             .camera_from_model = drawn.camera.camera_from_world * drawn.objects[object].town_from_mesh,
                             .view = row.view,
                             .box = row.box,
                             .visible = row.visible});
  }
  VICTORIOUS_RETURN_IF_ERROR(
      DegradeImage(degradation, MixSeed(scene.seed, static_cast<std::uint64_t>(frame)), known.bgr));
  return known;
}

namespace {

// The pose of an upright object: the centre of its bounding box at the true place, its front (+x) towards the heading.
Rigid3 CameraFromModel(const TruthRow& row, const Eigen::AlignedBox3d& box, const TangentPlane& earth,
                       const Eigen::Quaterniond& camera_from_enu) {
  const Eigen::Quaterniond enu_from_model(Eigen::AngleAxisd(kPi / 2 - *row.heading_rad, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d middle = earth.EnuFromGeodetic(*row.place);
  const Rigid3 pose{enu_from_model, middle - enu_from_model * box.center()};
  return Rigid3{camera_from_enu, Eigen::Vector3d::Zero()} * pose;
}

const CameraState* StateAt(const std::vector<CameraState>& states, double time_s) {
  const auto nearest =
      std::ranges::min_element(states, {}, [&](const CameraState& state) { return std::abs(state.time_s - time_s); });
  return nearest == states.end() || !nearest->IsComplete() ? nullptr : &*nearest;
}

// The meshes of a movie's objects, each loaded once.
class MovieMeshes {
 public:
  MovieMeshes(std::filesystem::path folder, Renderer& renderer) : folder_(std::move(folder)), renderer_(renderer) {}

  /// Null for a model without a file.
  Expected<const UploadedMesh*> Find(const std::string& kind) {
    if (const auto known = meshes_.find(kind); known != meshes_.end()) return &known->second;
    const std::filesystem::path file = folder_ / (kind + ".glb");
    if (!std::filesystem::exists(file)) return nullptr;
    VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(file));
    VICTORIOUS_ASSIGN_OR_RETURN(const MeshId id, renderer_.Upload(loaded.mesh));
    return &meshes_.emplace(kind, UploadedMesh{id, BoundingBox(loaded.mesh)}).first->second;
  }

 private:
  std::filesystem::path folder_;
  Renderer& renderer_;
  std::map<std::string, UploadedMesh> meshes_;
};

}  // namespace

Expected<std::vector<AnnotatedImage>> ReadLabelledMovie(const std::filesystem::path& folder,
                                                        const std::filesystem::path& models, int frames,
                                                        Renderer& renderer) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TruthRow> truth, ReadTruth(folder / "truth.jsonl"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string table, ReadFile(folder / "telemetry.csv"));
  VICTORIOUS_ASSIGN_OR_RETURN(const CameraRows cameras, ParseCameraCsv(table));
  const std::filesystem::path video = folder / "video.mp4";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t length, CountFrames(video));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> chosen,
                              ReadNumberedFrames(video, EvenlySpaced(length, frames), FrameColor::kBgr));
  MovieMeshes meshes(models, renderer);
  std::vector<AnnotatedImage> scenes;
  for (const Frame& frame : chosen) {
    const CameraState* const camera = StateAt(cameras.states, frame.time_s);
    if (camera == nullptr) continue;
    const TangentPlane earth(camera->place);
    const Eigen::Quaterniond camera_from_enu = CameraFromEnu(*camera->attitude);
    AnnotatedImage known{.name = fmt::format("{}, frame {}", folder.filename().string(), frame.index),
                         .bgr = frame.image,
                         .pinhole = CentredPinhole(*camera->hfov_rad, frame.image.cols, frame.image.rows),
                         .depth_m = {},
                         .objects = {}};
    std::vector<MeshInstance> instances;
    for (const TruthRow& row : truth) {
      if (row.frame != frame.index || !row.place || !row.heading_rad || !row.view) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(const UploadedMesh* const mesh, meshes.Find(row.model));
      if (mesh == nullptr) continue;
      const Rigid3 camera_from_model = CameraFromModel(row, mesh->box, earth, camera_from_enu);
      instances.push_back({mesh->id, camera_from_model});
      known.objects.push_back({.model = row.model,
                               .camera_from_model = camera_from_model,
                               .view = *row.view,
                               .box = row.box,
                               .visible = row.visible});
    }
    // The world frame is the camera frame here; only the light depends on the up direction, and only depth is used.
    VICTORIOUS_ASSIGN_OR_RETURN(RenderedView view, renderer.Render(instances, {known.pinhole, {}}));
    known.depth_m = std::move(view.depth_m);
    scenes.push_back(std::move(known));
  }
  return scenes;
}

}  // namespace victorious
