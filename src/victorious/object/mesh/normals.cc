#include "victorious/object/mesh/normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3f;

constexpr double kCreaseAngle = RadiansFromDegrees(40);
constexpr std::size_t kMaxNeighbours = 64;  // a point with more corners (tip of a fan) uses the first ones

struct Corner {
  std::uint32_t triangle;
  std::uint32_t corner;  // 0 to 2
};

bool HasNormals(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return std::ranges::all_of(
      triangle, [&](std::uint32_t vertex) { return std::abs(mesh.normals[vertex].norm() - 1.0F) < 0.01F; });
}

// Normal of the triangle, scaled by twice its area.
Vector3f AreaVector(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vector3f& origin = mesh.positions[triangle[0]];
  return (mesh.positions[triangle[1]] - origin).cross(mesh.positions[triangle[2]] - origin);
}

const Vector3f& CornerPosition(const Mesh& mesh, const Corner& corner) {
  return mesh.positions[mesh.triangles[corner.triangle][corner.corner]];
}

// The corners of the triangles, sorted by position: corners at the same point are adjacent.
std::vector<Corner> CornersByPosition(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<Corner> corners;
  corners.reserve(3 * triangles.size());
  for (const std::uint32_t triangle : triangles) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) corners.push_back({triangle, corner});
  }
  const auto before = [&](const Corner& a, const Corner& b) {
    const Vector3f& p = CornerPosition(mesh, a);
    const Vector3f& q = CornerPosition(mesh, b);
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::ranges::stable_sort(corners, before);
  return corners;
}

// Replaces the vertex of a corner by a copy with its own normal.
void SplitCorner(Mesh& mesh, const Corner& corner, const Vector3f& normal) {
  std::uint32_t& vertex = mesh.triangles[corner.triangle][corner.corner];
  const std::uint32_t old = vertex;
  vertex = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back(Vector3f(mesh.positions[old]));
  mesh.normals.push_back(normal);
  mesh.uvs.push_back(Eigen::Vector2f(mesh.uvs[old]));
  if (!mesh.colours.empty()) mesh.colours.push_back(Eigen::Vector4f(mesh.colours[old]));
}

}  // namespace

void FillMissingNormals(Mesh& mesh) {
  std::vector<std::uint32_t> missing;
  std::vector<Vector3f> area_vectors(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (HasNormals(mesh, mesh.triangles[i])) continue;
    missing.push_back(i);
    area_vectors[i] = AreaVector(mesh, mesh.triangles[i]);
  }
  const std::vector<Corner> corners = CornersByPosition(mesh, missing);
  const float cos_crease = static_cast<float>(std::cos(kCreaseAngle));
  for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
    const Vector3f position = CornerPosition(mesh, corners[begin]);
    while (end < corners.size() && CornerPosition(mesh, corners[end]) == position) ++end;
    const std::size_t neighbours_end = std::min(end, begin + kMaxNeighbours);
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3f& own = area_vectors[corners[i].triangle];
      Vector3f sum = own;
      for (std::size_t j = begin; j < neighbours_end; ++j) {
        const Vector3f& other = area_vectors[corners[j].triangle];
        if (j != i && other.dot(own) > cos_crease * other.norm() * own.norm()) sum += other;
      }
      const float length = sum.norm();
      SplitCorner(mesh, corners[i], length > 0 ? Vector3f(sum / length) : Vector3f(Vector3f::UnitZ()));
    }
  }
}

}  // namespace victorious
