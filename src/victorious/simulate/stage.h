// The scene as the renderer holds it: every CAD file loaded once, everything standing in its place, and of all that
// what a camera can see at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/render/renderer.h"
#include "victorious/simulate/scene.h"
#include "victorious/simulate/town.h"

namespace victorious {

/// A mesh on the renderer.
struct StagedMesh {
  MeshId id = {};
  Eigen::AlignedBox3d box;  ///< in the model frame (mesh.h)
};

/// A mesh in its place in the town.
struct StagedThing {
  StagedMesh mesh;
  Rigid3 town_from_mesh;
};

class Stage {
 public:
  /// Loads and places everything. `warn` is told what is damaged in CAD files, a line each; `renderer` must outlive it.
  /// Errors: those of LoadMesh, with the file's name; kCancelled.
  static Expected<Stage> Build(const Scene& scene, Renderer& renderer, const CancelToken& cancel,
                               const std::function<void(const std::string&)>& warn);

  /// The scene's objects, in its order, where they are at a time.
  [[nodiscard]] std::vector<StagedThing> ObjectsAt(double time_s) const;

  /// The town's things that a camera sees, or whose shadow it may see.
  /// @param to_sun_in_town  of length 1, above the horizon
  [[nodiscard]] std::vector<MeshInstance> TownSeenFrom(const PosedCamera& camera,
                                                       const Eigen::Vector3d& to_sun_in_town) const;

 private:
  class Loader;

  Status PlaceObjects(const Scene& scene, Loader& loader, std::vector<KeptClear>& clear);
  Status PlacePieces(const Scene& scene, Loader& loader, std::vector<KeptClear>& clear);
  Status PlaceTown(const Scene& scene, Loader& loader, const std::vector<KeptClear>& clear);

  std::vector<SceneObject> objects_;
  std::vector<StagedMesh> object_meshes_;  ///< of objects_
  std::vector<StagedThing> town_;
  double lowest_m_ = 0;  ///< of all that stands in the town, the ground included
};

}  // namespace victorious
