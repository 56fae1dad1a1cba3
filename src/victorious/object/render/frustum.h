// The camera's view frustum as planes.
#pragma once

#include <array>

#include <Eigen/Core>

#include "victorious/geometry/camera.h"

namespace victorious {

/// The normals, in the camera frame, of the four planes through the camera centre and the image's edges: left, right,
/// top, bottom. They point inwards and are not of unit length.
[[nodiscard]] inline std::array<Eigen::Vector3d, 4> FrustumNormals(const PinholeCamera& camera) {
  using Eigen::Vector3d;
  return {Vector3d(camera.fx, 0, camera.cx), Vector3d(-camera.fx, 0, camera.width - camera.cx),
          Vector3d(0, camera.fy, camera.cy), Vector3d(0, -camera.fy, camera.height - camera.cy)};
}

}  // namespace victorious
