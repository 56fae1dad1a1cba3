// For tests: small CAD files of every format, written here.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>

#include "victorious/render/mesh.h"

namespace victorious::testing {

/// A box between two corners: 24 vertices, 12 triangles, six parts with a material each, in the order of
/// `colours` (linear): the faces -x, +x, -y, +y, -z, +z. Each face's texture coordinates go from (0, 0) to (1, 1).
Mesh Box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, const std::array<Eigen::Vector3f, 6>& colours);
/// All white.
Mesh Box(const Eigen::Vector3f& low, const Eigen::Vector3f& high);

/// Adds a mesh's triangles to the last part of another. Both have normals and texture coordinates.
void Append(const Mesh& block, Mesh& mesh);

/// An upright square of side 2 about the origin, seen from +z, with a texture that is upright there.
Mesh TexturedSquare(const cv::Mat& bgra);

struct GlbExtras {
  std::string node;          ///< members of the node, e.g. R"("translation":[1,0,0])"
  std::string texture_info;  ///< members of each baseColorTexture besides its index
  std::string top;           ///< members of the whole
  std::string image_uri;     ///< textures lie there instead of in the file
};

// A mesh as a file, its positions as they are.
std::string GlbFrom(const Mesh& mesh, const GlbExtras& extras = {});
/// Positions, texture coordinates, normals; the colours of parts go into `ObjMaterials` as "part0", "part1", ….
std::string ObjFrom(const Mesh& mesh, const std::string& mtl_name = "");
std::string ObjMaterials(const Mesh& mesh, const std::string& texture_name = "");
/// Vertex colours as bytes, where the mesh has some.
std::string PlyFrom(const Mesh& mesh);
std::string StlFrom(const Mesh& mesh);
std::string StlTextFrom(const Mesh& mesh);
std::string Ac3dFrom(const Mesh& mesh);
std::string ColladaFrom(const Mesh& mesh, const std::string& up_axis = "Y_UP", double unit_m = 1.0);
std::string ThreeDsFrom(const Mesh& mesh);

/// A GLB of this JSON and binary chunk, whatever they hold.
std::string GlbOf(std::string json, std::string binary);

}  // namespace victorious::testing
