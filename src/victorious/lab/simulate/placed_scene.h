// The scene on the renderer: loads every CAD file once, places all instances, and culls them per camera.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/lab/simulate/scene.h"
#include "victorious/lab/simulate/town.h"
#include "victorious/object/render/renderer.h"

namespace victorious {

/// A mesh uploaded to the renderer.
struct UploadedMesh {
  MeshId id = {};
  Eigen::AlignedBox3d box;  ///< in the model frame (mesh.h)
};

/// A mesh placed in the town.
struct PlacedMesh {
  UploadedMesh mesh;
  Rigid3 town_from_mesh;
  Eigen::Vector2d velocity_in_town = Eigen::Vector2d::Zero();  ///< over the ground, m/s
};

class PlacedScene {
 public:
  /// Loads and places everything. `warn` gets one line for each damaged part of a CAD file. `renderer` must outlive the
  /// result.
  /// Errors: those of LoadMesh, with the file's name; kCancelled.
  [[nodiscard]] static Expected<PlacedScene> Build(const Scene& scene, Renderer& renderer, const CancelToken& cancel,
                                                   const std::function<void(const std::string&)>& warn);

  /// The scene's objects in its order, at their poses at a time.
  [[nodiscard]] std::vector<PlacedMesh> ObjectsAt(double time_s) const;

  /// Frustum culling: the instances of the town that are visible to the camera, or whose shadow may be.
  /// @param to_sun_in_town  unit vector, above the horizon
  [[nodiscard]] std::vector<MeshInstance> FindVisibleTownInstances(const PosedCamera& camera,
                                                                   const Eigen::Vector3d& to_sun_in_town) const;

 private:
  class Loader;

  [[nodiscard]] Status PlaceObjects(const Scene& scene, Loader& loader, std::vector<ClearZone>& clear);
  [[nodiscard]] Status PlacePieces(const Scene& scene, Loader& loader, std::vector<ClearZone>& clear);
  [[nodiscard]] Status PlaceTown(const Scene& scene, Loader& loader, const std::vector<ClearZone>& clear);

  std::vector<SceneObject> objects_;
  std::vector<UploadedMesh> object_meshes_;  ///< of objects_
  std::vector<PlacedMesh> town_;
  double lowest_m_ = 0;  ///< minimum z of all instances of the town and of the ground
};

}  // namespace victorious
