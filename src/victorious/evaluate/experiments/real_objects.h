// Things of which both pictures and a CAD file are at hand (real/recognition in the folder of outside data).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/render/mesh.h"

namespace victorious {

/// One picture of it.
struct RealView {
  cv::Mat bgr;
  double focal_px = 0;
  /// How the object stands, from the mesh's axes about the middle of its bounding box; where that is known.
  std::optional<Rigid3> camera_from_object;
};

struct RealObject {
  std::string name;
  Mesh mesh;                          ///< of one colour at most
  std::vector<RealView> views;        ///< the first one's pose is exact
  PosedCamera first_camera;           ///< of the first view; the mesh is the world
  std::vector<RealView> other_views;  ///< by another camera, in another place
};

/// The tea box, the cube and the dragon. Errors: kNotFound, and those of reading.
Expected<std::vector<RealObject>> LoadRealObjects(const std::filesystem::path& data);

}  // namespace victorious
