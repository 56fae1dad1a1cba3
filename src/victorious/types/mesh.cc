#include "victorious/types/mesh.h"

#include <algorithm>
#include <cmath>

namespace victorious {

Eigen::AlignedBox3d BoundingBox(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) box.extend(mesh.positions[vertex].cast<double>());
  }
  return box;
}

Sphere BoundingSphere(const Mesh& mesh) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  if (box.isEmpty()) return {};
  Sphere sphere{.centre = box.center()};
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      sphere.radius = std::max(sphere.radius, (mesh.positions[vertex].cast<double>() - sphere.centre).norm());
    }
  }
  return sphere;
}

}  // namespace victorious
