// Real objects with both images and a CAD file (real/recognition in the folder of external data), for figure 3.18.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/types/mesh.h"

namespace victorious {

/// One image of the object.
struct RealView {
  cv::Mat bgr;
  double focal_px = 0;
  /// True object pose, if known. The object's frame has the mesh's axes and its origin at the centre of the mesh's
  /// bounding box.
  std::optional<Rigid3> camera_from_object;
};

struct RealObject {
  std::string name;
  Mesh mesh;  ///< of at most one colour
  std::vector<RealView> views;
  PosedCamera first_camera;           ///< of the first view; the mesh frame is the world frame
  std::vector<RealView> other_views;  ///< by another camera at another place
};

/// Loads the tea box, the cube and the dragon. Errors: kNotFound, and those of reading.
[[nodiscard]] Expected<std::vector<RealObject>> LoadRealObjects(const std::filesystem::path& data);

}  // namespace victorious
