// Triangle mesh with materials: LoadMesh (load_mesh.h) makes it, Renderer (renderer.h) draws it.
//
// Model frame, the same for every object, metres: x to the object's front, y to its left, z up; the origin is that of
// the CAD file. Right-handed: front x left = up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/sphere.h"

namespace victorious {

enum class AlphaMode {
  kOpaque,  ///< alpha is ignored
  kMask,    ///< opaque where alpha >= alpha_cutoff, not drawn elsewhere
  kBlend,   ///< alpha-blended over the surfaces behind
};

/// Texture addressing outside [0, 1].
enum class TextureWrap { kRepeat, kClamp, kMirror };

struct Material {
  std::string name;
  Eigen::Vector4f base_colour = Eigen::Vector4f::Ones();  ///< red, green, blue (linear), alpha; 0 to 1
  int texture = -1;                                       ///< index into Mesh::textures; -1: no texture
  TextureWrap wrap_u = TextureWrap::kRepeat;
  TextureWrap wrap_v = TextureWrap::kRepeat;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5F;  ///< 0 to 1, for kMask
  bool double_sided = false;  ///< false: only front faces (vertices counter-clockwise) are drawn
};

/// A contiguous range of triangles with one material.
struct MeshPart {
  int material = 0;  ///< index into Mesh::materials
  std::uint32_t first_triangle = 0;
  std::uint32_t triangles = 0;
};

/// The colour of a surface point is base_colour * texture * vertex colour. Per-vertex arrays have the length of
/// `positions`.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;  ///< m, model frame, finite
  std::vector<Eigen::Vector3f> normals;    ///< of unit length
  std::vector<Eigen::Vector2f> uvs;        ///< (0, 0) is the texture's left upper corner, (1, 1) its right lower one
  std::vector<Eigen::Vector4f> colours;    ///< red, green, blue (linear), alpha; 0 to 1; empty: all vertices are white
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex indices, each below positions.size()
  std::vector<MeshPart> parts;                          ///< in triangle order; together they cover all triangles
  std::vector<Material> materials;
  std::vector<cv::Mat> textures;  ///< CV_8UC4: blue, green, red (sRGB), alpha, not premultiplied
};

/// Bounding box of the vertices that triangles use; empty (isEmpty()) for a mesh without triangles.
[[nodiscard]] Eigen::AlignedBox3d BoundingBox(const Mesh& mesh);

/// The sphere about the centre of the bounding box through the vertex farthest from it. Its radius is at most sqrt(3)
/// times that of the smallest bounding sphere.
[[nodiscard]] Sphere BoundingSphere(const Mesh& mesh);

}  // namespace victorious
