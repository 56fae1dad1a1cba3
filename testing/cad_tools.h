// Test tools: builds small meshes and writes them as CAD files of every supported format.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>

#include "victorious/types/mesh.h"

namespace victorious::testing {

/// An axis-aligned box from `low` to `high`: 24 vertices, 12 triangles, six parts with one material each, in the order
/// of `colours` (linear): the faces -x, +x, -y, +y, -z, +z. The texture coordinates of each face span (0, 0) to (1, 1).
Mesh Box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, const std::array<Eigen::Vector3f, 6>& colours);
/// The same box, all white.
Mesh Box(const Eigen::Vector3f& low, const Eigen::Vector3f& high);

/// Adds the triangles of `block` to the last part of `mesh`. Both meshes have normals and texture coordinates.
void Append(const Mesh& block, Mesh& mesh);

/// An upright square of side 2 centred at the origin. It faces +z; its texture is upright when seen from there.
Mesh TexturedSquare(const cv::Mat& bgra);

struct GlbExtras {
  std::string node;          ///< extra JSON members of the node, e.g. R"("translation":[1,0,0])"
  std::string texture_info;  ///< extra JSON members of each baseColorTexture
  std::string top;           ///< extra top-level JSON members
  std::string image_uri;     ///< URI of the textures; empty: they are embedded in the file
};

// The functions below return a mesh as the bytes of a file. Positions are written unchanged.
std::string GlbFrom(const Mesh& mesh, const GlbExtras& extras = {});
/// Writes positions, texture coordinates and normals. ObjMaterials() writes the colours of the parts, as the materials
/// "part0", "part1", ….
std::string ObjFrom(const Mesh& mesh, const std::string& mtl_name = "");
std::string ObjMaterials(const Mesh& mesh, const std::string& texture_name = "");
/// Writes vertex colours as bytes if the mesh has vertex colours.
std::string PlyFrom(const Mesh& mesh);
std::string StlFrom(const Mesh& mesh);
std::string StlTextFrom(const Mesh& mesh);
std::string Ac3dFrom(const Mesh& mesh);
std::string ColladaFrom(const Mesh& mesh, const std::string& up_axis = "Y_UP", double unit_m = 1.0);
std::string ThreeDsFrom(const Mesh& mesh);

/// A GLB container with the given JSON and binary chunks; their content is not checked.
std::string GlbFromChunks(std::string json, std::string binary);

}  // namespace victorious::testing
