// The object as triangles with materials: what every CAD file becomes (load_mesh.h) and what is drawn (renderer.h).
//
// The model frame is the same for every object, metres: x points to the object's front, y to its left, z up; its origin
// is the file's. (Right-handed: front x left = up.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace victorious {

enum class AlphaMode {
  kOpaque,  ///< alpha is ignored
  kMask,    ///< drawn where alpha >= alpha_cutoff, and opaque there
  kBlend,   ///< mixed with what lies behind
};

/// What a texture shows beyond its edges.
enum class TextureWrap { kRepeat, kClamp, kMirror };

struct Material {
  std::string name;
  Eigen::Vector4f base_colour = Eigen::Vector4f::Ones();  ///< red, green, blue (linear), alpha; 0 to 1
  int texture = -1;                                       ///< index into Mesh::textures; -1: none
  TextureWrap wrap_u = TextureWrap::kRepeat;
  TextureWrap wrap_v = TextureWrap::kRepeat;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5F;  ///< 0 to 1, for kMask
  bool double_sided = false;  ///< false: triangles are seen only from where their corners go counter-clockwise
};

/// A run of triangles of one material.
struct MeshPart {
  int material = 0;  ///< index into Mesh::materials
  std::uint32_t first_triangle = 0;
  std::uint32_t triangles = 0;
};

/// The colour of a point is base_colour * texture * vertex colour. Arrays by vertex are as long as `positions`.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;  ///< m, model frame, finite
  std::vector<Eigen::Vector3f> normals;    ///< of unit length
  std::vector<Eigen::Vector2f> uvs;        ///< (0, 0) is the texture's left upper corner, (1, 1) its right lower one
  std::vector<Eigen::Vector4f> colours;    ///< red, green, blue (linear), alpha; 0 to 1; empty: all white
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of vertices, each below positions.size()
  std::vector<MeshPart> parts;                          ///< in the order of their triangles, all of them
  std::vector<Material> materials;
  std::vector<cv::Mat> textures;  ///< CV_8UC4: blue, green, red (sRGB), alpha, not premultiplied
};

/// Of the vertices that a triangle uses; empty (isEmpty()) for a mesh without triangles.
[[nodiscard]] Eigen::AlignedBox3d BoundingBox(const Mesh& mesh);

struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
};

/// About the centre of the bounding box, through the vertex farthest from it: at most sqrt(3) times the smallest one.
[[nodiscard]] Sphere BoundingSphere(const Mesh& mesh);

}  // namespace victorious
