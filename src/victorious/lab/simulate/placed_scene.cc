#include "victorious/lab/simulate/placed_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/lab/simulate/flight_path.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/object/render/frustum.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace fs = std::filesystem;

constexpr double kMaterialSideM = 20;  // side of a texture of town/ground; it tiles seamlessly

// A flat square centred at the origin, textured with period kMaterialSideM.
Mesh MakeGroundSquare(const cv::Mat& bgr, double side_m) {
  const auto half = static_cast<float>(side_m / 2);
  const auto repeats = static_cast<float>(side_m / kMaterialSideM);
  Mesh mesh;
  mesh.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh.uvs = {{0, repeats}, {repeats, repeats}, {repeats, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.parts = {{.material = 0, .first_triangle = 0, .triangles = 2}};
  mesh.materials = {{.name = "ground", .texture = 0}};
  cv::Mat bgra;
  cv::cvtColor(bgr, bgra, cv::COLOR_BGR2BGRA);
  mesh.textures = {bgra};
  return mesh;
}

// The pose of a mesh in the town. The front of the model frame is x; headings in the town are clockwise from y.
Rigid3 TownFromMesh(const UploadedMesh& mesh, const GroundPose& pose, double bottom_m) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(kPi / 2 - pose.heading_rad, Vector3d::UnitZ()));
  const Vector3d foot(mesh.box.center().x(), mesh.box.center().y(), mesh.box.min().z());
  return {turn, Vector3d(pose.place_m.x(), pose.place_m.y(), bottom_m) - turn * foot};
}

// Maximum and minimum z in the town frame. All instances are upright: the up axes of mesh and town are parallel.
double TopHeight(const PlacedMesh& instance) {
  return instance.town_from_mesh.translation.z() + instance.mesh.box.max().z();
}
double BottomHeight(const PlacedMesh& instance) {
  return instance.town_from_mesh.translation.z() + instance.mesh.box.min().z();
}

// Adds the zones that the town must keep free: the object's position, or its path sampled over the flight.
void AddClearZones(const SceneObject& object, const UploadedMesh& mesh, double last_s, std::vector<ClearZone>& clear) {
  const double radius_m = mesh.box.sizes().head<2>().norm() / 2;
  const double length_m = mesh.box.sizes().x();
  constexpr double kMinStepS = 0.01;
  double fastest_m_s = object.speed_m_s;
  constexpr double kSteepest = 1.5;  // of a monotone cubic between two points, over its mean slope
  for (std::size_t i = 1; i < object.times_s.size(); ++i) {
    const double section_m = (object.path_m[i] - object.path_m[i - 1]).norm();
    fastest_m_s = std::max(fastest_m_s, kSteepest * section_m / (object.times_s[i] - object.times_s[i - 1]));
  }
  const double step_s = fastest_m_s > 0 ? std::max({radius_m / fastest_m_s, last_s / 1000, kMinStepS}) : last_s + 1;
  for (double time_s = 0; time_s <= last_s; time_s += step_s) {
    clear.push_back({ComputeGroundPose(object, length_m, time_s).place_m, radius_m});
  }
}

}  // namespace

class PlacedScene::Loader {
 public:
  Loader(Renderer& renderer, const CancelToken& cancel, const std::function<void(const std::string&)>& warn)
      : renderer_(renderer), cancel_(cancel), warn_(warn) {}

  Expected<UploadedMesh> Load(const fs::path& file) {
    if (const auto known = meshes_.find(file); known != meshes_.end()) return known->second;
    if (cancel_.IsCancelled()) return Fail(ErrorCode::kCancelled, "stopped while loading the scene");
    VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(file));
    for (const std::string& warning : loaded.warnings) warn_(fmt::format("{}: {}", file.string(), warning));
    return Upload(file, loaded.mesh);
  }

  Expected<UploadedMesh> LoadGround(const fs::path& path, double side_m) {
    const fs::path key = fmt::format("{} {}", path.string(), side_m);
    if (const auto known = meshes_.find(key); known != meshes_.end()) return known->second;
    VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(path));
    return Upload(key, MakeGroundSquare(image.bgr, side_m));
  }

 private:
  Expected<UploadedMesh> Upload(const fs::path& key, const Mesh& mesh) {
    VICTORIOUS_ASSIGN_OR_RETURN(const MeshId id, renderer_.Upload(mesh));
    return meshes_.emplace(key, UploadedMesh{id, BoundingBox(mesh)}).first->second;
  }

  Renderer& renderer_;
  const CancelToken& cancel_;
  const std::function<void(const std::string&)>& warn_;
  std::map<fs::path, UploadedMesh> meshes_;
};

Status PlacedScene::PlaceObjects(const Scene& scene, Loader& loader, std::vector<ClearZone>& clear) {
  const double last_s = (scene.video.frames - 1) / scene.video.fps;
  for (const SceneObject& object : scene.objects) {
    const fs::path file =
        object.file.empty() ? scene.assets / "models" / (object.model + ".glb") : scene.folder / object.file;
    VICTORIOUS_ASSIGN_OR_RETURN(const UploadedMesh mesh, loader.Load(file));
    AddClearZones(object, mesh, last_s, clear);
    objects_.push_back(object);
    object_meshes_.push_back(mesh);
  }
  return {};
}

Status PlacedScene::PlacePieces(const Scene& scene, Loader& loader, std::vector<ClearZone>& clear) {
  for (const ScenePiece& piece : scene.pieces) {
    VICTORIOUS_ASSIGN_OR_RETURN(const UploadedMesh mesh, loader.Load(scene.assets / (piece.asset + ".glb")));
    const GroundPose pose{{piece.x_m, piece.y_m}, RadiansFromDegrees(piece.heading_deg)};
    clear.push_back({pose.place_m, mesh.box.sizes().head<2>().norm() / 2});
    town_.push_back({mesh, TownFromMesh(mesh, pose, piece.z_m)});
  }
  return {};
}

Status PlacedScene::PlaceTown(const Scene& scene, Loader& loader, const std::vector<ClearZone>& clear) {
  const std::vector<Placement> placements = LayOutTown(scene.town);
  std::vector<UploadedMesh> meshes;
  std::vector<Vector2d> sizes_m;
  for (const Placement& placement : placements) {
    const std::string file = (scene.assets / placement.asset).string();
    VICTORIOUS_ASSIGN_OR_RETURN(const UploadedMesh mesh, placement.side_m > 0
                                                             ? loader.LoadGround(file + ".jpg", placement.side_m)
                                                             : loader.Load(file + ".glb"));
    meshes.push_back(mesh);
    sizes_m.emplace_back(mesh.box.sizes().head<2>());
  }
  const std::vector<bool> stands = FindUnobstructed(placements, sizes_m, clear);
  for (std::size_t i = 0; i < placements.size(); ++i) {
    if (!stands[i]) continue;
    const GroundPose pose{placements[i].place_m, placements[i].heading_rad};
    town_.push_back({meshes[i], TownFromMesh(meshes[i], pose, placements[i].bottom_m)});
  }
  return {};
}

Expected<PlacedScene> PlacedScene::Build(const Scene& scene, Renderer& renderer, const CancelToken& cancel,
                                         const std::function<void(const std::string&)>& warn) {
  PlacedScene placed;
  Loader loader(renderer, cancel, warn);
  std::vector<ClearZone> clear;
  VICTORIOUS_RETURN_IF_ERROR(placed.PlaceObjects(scene, loader, clear));
  VICTORIOUS_RETURN_IF_ERROR(placed.PlacePieces(scene, loader, clear));
  VICTORIOUS_RETURN_IF_ERROR(placed.PlaceTown(scene, loader, clear));
  // Draws from top to bottom: high instances occlude lower ones, and occluded fragments fail the depth test early.
  std::ranges::stable_sort(placed.town_, std::greater(), TopHeight);
  for (const PlacedMesh& instance : placed.town_) placed.lowest_m_ = std::min(placed.lowest_m_, BottomHeight(instance));
  return placed;
}

std::vector<PlacedMesh> PlacedScene::ObjectsAt(double time_s) const {
  std::vector<PlacedMesh> instances;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const UploadedMesh& mesh = object_meshes_[i];
    const double length_m = mesh.box.sizes().x();
    const GroundPose pose = ComputeGroundPose(objects_[i], length_m, time_s);
    instances.push_back(
        {mesh, TownFromMesh(mesh, pose, objects_[i].z_m), ComputeGroundVelocity(objects_[i], length_m, time_s)});
  }
  return instances;
}

namespace {

// The camera's view frustum, for instances in the town frame.
class SceneFrustum {
 public:
  explicit SceneFrustum(const PosedCamera& camera)
      : camera_from_town_(camera.camera_from_world), normals_(FrustumNormals(camera.pinhole)) {
    for (Vector3d& normal : normals_) normal.normalize();
  }

  // True if a sphere moving along a line segment intersects the frustum anywhere (swept sphere test).
  [[nodiscard]] bool IntersectsSweptSphere(const Vector3d& from_in_town, const Vector3d& to_in_town,
                                           double radius_m) const {
    const Vector3d from = camera_from_town_.Apply(from_in_town);
    const Vector3d to = camera_from_town_.Apply(to_in_town);
    double enters = 0;  // parameters on the segment, 0 to 1
    double leaves = 1;
    for (const Vector3d& normal : normals_) {
      const double at_start = normal.dot(from) + radius_m;
      const double at_end = normal.dot(to) + radius_m;
      if (at_start <= 0 && at_end <= 0) return false;
      if (at_start < 0) enters = std::max(enters, at_start / (at_start - at_end));
      if (at_end < 0) leaves = std::min(leaves, at_start / (at_start - at_end));
    }
    return enters <= leaves;
  }

 private:
  Rigid3 camera_from_town_;
  std::array<Vector3d, 4> normals_;  ///< unit vectors, inwards
};

}  // namespace

std::vector<MeshInstance> PlacedScene::FindVisibleTownInstances(const PosedCamera& camera,
                                                                const Vector3d& to_sun_in_town) const {
  const SceneFrustum frustum(camera);
  std::vector<MeshInstance> seen;
  for (const PlacedMesh& instance : town_) {
    const Eigen::AlignedBox3d& box = instance.mesh.box;
    const double radius_m = box.diagonal().norm() / 2;
    const Vector3d centre = instance.town_from_mesh.Apply(box.center());
    // Its bounding sphere, swept along the sun's rays until its top reaches the lowest ground, contains its shadow.
    const Vector3d fall = (TopHeight(instance) - lowest_m_) / to_sun_in_town.z() * to_sun_in_town;
    if (frustum.IntersectsSweptSphere(centre, centre - fall, radius_m)) {
      seen.push_back({.mesh = instance.mesh.id, .world_from_mesh = instance.town_from_mesh});
    }
  }
  return seen;
}

}  // namespace victorious
