#include "victorious/lab/simulate/flight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/degrade.h"
#include "victorious/lab/simulate/flight_path.h"

namespace victorious {
namespace {

// Independent random streams derived from the scene's seed.
enum SeedUse : std::uint64_t { kShakeSeed = 0x5A01, kNoiseSeed = 0x5A02 };

Light MakeLight(const Scene& scene) {
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

}  // namespace

Flight::Flight(const Scene& scene, Renderer& renderer, const PlacedScene& placed)
    : scene_(scene), renderer_(renderer), placed_(placed), light_(MakeLight(scene)) {}

// The objects come first: instance i < objects.size() is object i.
std::vector<MeshInstance> Flight::Instances(const std::vector<PlacedMesh>& objects, const PosedCamera& camera) const {
  std::vector<MeshInstance> instances(objects.size());
  std::ranges::transform(objects, instances.begin(), [](const PlacedMesh& object) {
    return MeshInstance{.mesh = object.mesh.id, .world_from_mesh = object.town_from_mesh};
  });
  const std::vector<MeshInstance> town = placed_.FindVisibleTownInstances(camera, light_.to_sun_in_world);
  instances.insert(instances.end(), town.begin(), town.end());
  return instances;
}

Expected<RenderedFrame> Flight::Draw(int frame) {
  const SceneVideo& video = scene_.video;
  RenderedFrame drawn;
  drawn.time_s = frame / video.fps;
  const double fraction = video.frames > 1 ? static_cast<double>(frame) / (video.frames - 1) : 0.0;
  drawn.camera = {MakePinhole(video),
                  CameraFromTown(scene_.camera, fraction, drawn.time_s, MixSeed(scene_.seed, kShakeSeed))};
  drawn.objects = placed_.ObjectsAt(drawn.time_s);
  VICTORIOUS_ASSIGN_OR_RETURN(drawn.view, renderer_.Render(Instances(drawn.objects, drawn.camera), drawn.camera, light_,
                                                           {.supersampling = video.supersampling}));
  drawn.bgr = drawn.view.bgr.clone();
  Degrade({.blur_px = video.blur_px, .grain = video.grain, .noise = video.noise},
          MixSeed(MixSeed(scene_.seed, kNoiseSeed), static_cast<std::uint64_t>(frame)), drawn.bgr);
  return drawn;
}

}  // namespace victorious
