#include "testing/cad_tools.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "victorious/base/check.h"

namespace victorious::testing {
namespace {

using Eigen::Vector3f;

template <typename T>
std::string Bytes(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <typename T>
std::string Bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string PngOf(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  VICTORIOUS_CHECK(cv::imencode(".png", image, bytes));
  return {bytes.begin(), bytes.end()};
}

// The binary buffer of a GLB with its buffer views and accessors.
class GlbBuffer {
 public:
  int AddView(const std::string& bytes) {
    views_.push_back(fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}}})", data_.size(), bytes.size()));
    data_ += bytes;
    data_.resize((data_.size() + 3) / 4 * 4);
    return static_cast<int>(views_.size()) - 1;
  }
  int AddAccessor(const std::string& bytes, int component, std::size_t count, std::string_view type,
                  const std::string& more = "") {
    accessors_.push_back(fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})",
                                     AddView(bytes), component, count, type, more));
    return static_cast<int>(accessors_.size()) - 1;
  }
  [[nodiscard]] std::string Json() const {
    return fmt::format(R"("buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}])", data_.size(),
                       fmt::join(views_, ","), fmt::join(accessors_, ","));
  }
  [[nodiscard]] const std::string& data() const { return data_; }

 private:
  std::string data_;
  std::vector<std::string> views_;
  std::vector<std::string> accessors_;
};

std::string MaterialJson(const Material& material, const GlbExtras& extras) {
  const Eigen::Vector4f& c = material.base_colour;
  std::string colour = fmt::format(R"("baseColorFactor":[{},{},{},{}])", c.x(), c.y(), c.z(), c.w());
  if (material.texture >= 0) {
    colour += fmt::format(R"(,"baseColorTexture":{{"index":{}{}}})", material.texture,
                          extras.texture_info.empty() ? "" : "," + extras.texture_info);
  }
  std::string json = fmt::format(R"({{"pbrMetallicRoughness":{{{}}},"doubleSided":{})", colour, material.double_sided);
  if (material.alpha_mode == AlphaMode::kMask) {
    json += fmt::format(R"(,"alphaMode":"MASK","alphaCutoff":{})", material.alpha_cutoff);
  }
  if (material.alpha_mode == AlphaMode::kBlend) json += R"(,"alphaMode":"BLEND")";
  return json + "}";
}

std::string FloatArray(const std::string& id, std::span<const float> values) {
  return fmt::format(R"(<float_array id="{}" count="{}">{}</float_array>)", id, values.size(), fmt::join(values, " "));
}

// A chunk of 3DS: its number, its length with this head, its content.
std::string Chunk(std::uint16_t number, const std::string& content) {
  return Bytes(number) + Bytes(static_cast<std::uint32_t>(content.size() + 6)) + content;
}

}  // namespace

Mesh Box(const Vector3f& low, const Vector3f& high, const std::array<Vector3f, 6>& colours) {
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const bool positive = face % 2 == 1;
    const Vector3f normal = Vector3f::Unit(axis) * (positive ? 1.0F : -1.0F);
    const Vector3f across = Vector3f::Unit((axis + 1) % 3) * (positive ? 1.0F : -1.0F);
    const Vector3f along = normal.cross(across);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [s, t] : {std::pair(0.0F, 0.0F), {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
      const Vector3f corner = normal + (2 * s - 1) * across + (2 * t - 1) * along;  // of the box from -1 to 1
      mesh.positions.push_back(low + (0.5F * (corner + Vector3f::Ones())).cwiseProduct(high - low));
      mesh.normals.push_back(normal);
      mesh.uvs.emplace_back(s, t);
    }
    mesh.parts.push_back({face, static_cast<std::uint32_t>(mesh.triangles.size()), 2});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    Material material;
    material.base_colour.head<3>() = colours[static_cast<std::size_t>(face)];
    mesh.materials.push_back(material);
  }
  return mesh;
}

Mesh Box(const Vector3f& low, const Vector3f& high) {
  std::array<Vector3f, 6> white;
  white.fill(Vector3f::Ones());
  return Box(low, high, white);
}

void Append(const Mesh& block, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), block.positions.begin(), block.positions.end());
  mesh.normals.insert(mesh.normals.end(), block.normals.begin(), block.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), block.uvs.begin(), block.uvs.end());
  for (const auto& triangle : block.triangles) {
    mesh.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
  }
  mesh.parts.back().triangles += static_cast<std::uint32_t>(block.triangles.size());
}

Mesh TexturedSquare(const cv::Mat& bgra) {
  Mesh mesh;
  mesh.positions = {{-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}};
  mesh.normals.assign(4, Vector3f::UnitZ());
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.parts = {{0, 0, 2}};
  mesh.materials.resize(1);
  mesh.materials[0].texture = 0;
  mesh.textures = {bgra};
  return mesh;
}

std::string GlbFromChunks(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const auto size = static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size());
  return "glTF" + Bytes(std::uint32_t{2}) + Bytes(size) + Bytes(static_cast<std::uint32_t>(json.size())) + "JSON" +
         json + Bytes(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
}

std::string GlbFrom(const Mesh& mesh, const GlbExtras& extras) {
  constexpr int kFloat = 5126;
  constexpr int kUnsigned = 5125;
  GlbBuffer buffer;
  const std::size_t vertices = mesh.positions.size();
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const Eigen::Vector3d& low = box.min();
  const Eigen::Vector3d& high = box.max();
  const std::string range =
      fmt::format(R"(,"min":[{},{},{}],"max":[{},{},{}])", low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
  std::string attributes =
      fmt::format(R"("POSITION":{})", buffer.AddAccessor(Bytes(mesh.positions), kFloat, vertices, "VEC3", range));
  if (!mesh.normals.empty()) {
    attributes += fmt::format(R"(,"NORMAL":{})", buffer.AddAccessor(Bytes(mesh.normals), kFloat, vertices, "VEC3"));
  }
  if (!mesh.uvs.empty()) {
    attributes += fmt::format(R"(,"TEXCOORD_0":{})", buffer.AddAccessor(Bytes(mesh.uvs), kFloat, vertices, "VEC2"));
  }
  if (!mesh.colours.empty()) {
    attributes += fmt::format(R"(,"COLOR_0":{})", buffer.AddAccessor(Bytes(mesh.colours), kFloat, vertices, "VEC4"));
  }
  std::vector<std::string> primitives;
  for (const MeshPart& part : mesh.parts) {
    const auto first = mesh.triangles.begin() + part.first_triangle;
    const std::vector<std::array<std::uint32_t, 3>> triangles(first, first + part.triangles);
    primitives.push_back(fmt::format(R"({{"attributes":{{{}}},"indices":{},"material":{}}})", attributes,
                                     buffer.AddAccessor(Bytes(triangles), kUnsigned, triangles.size() * 3, "SCALAR"),
                                     part.material));
  }
  std::vector<std::string> materials;
  materials.reserve(mesh.materials.size());
  for (const Material& material : mesh.materials) materials.push_back(MaterialJson(material, extras));
  std::vector<std::string> images;
  std::vector<std::string> textures;
  for (const cv::Mat& texture : mesh.textures) {
    textures.push_back(fmt::format(R"({{"source":{}}})", images.size()));
    images.push_back(extras.image_uri.empty()
                         ? fmt::format(R"({{"bufferView":{},"mimeType":"image/png"}})", buffer.AddView(PngOf(texture)))
                         : fmt::format(R"({{"uri":"{}"}})", extras.image_uri));
  }
  std::string json =
      fmt::format(R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{}}}],)"
                  R"("meshes":[{{"primitives":[{}]}}],"materials":[{}],)",
                  extras.node.empty() ? "" : "," + extras.node, fmt::join(primitives, ","), fmt::join(materials, ","));
  if (!images.empty()) {
    json += fmt::format(R"("images":[{}],"textures":[{}],)", fmt::join(images, ","), fmt::join(textures, ","));
  }
  if (!extras.top.empty()) json += extras.top + ",";
  return GlbFromChunks(json + buffer.Json() + "}", buffer.data());
}

std::string ObjFrom(const Mesh& mesh, const std::string& mtl_name) {
  std::string text = mtl_name.empty() ? "" : "mtllib " + mtl_name + "\n";
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    const Vector3f& n = mesh.normals[i];
    text += fmt::format("v {} {} {}\nvn {} {} {}\nvt {} {}\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z(),
                        mesh.uvs[i].x(), 1 - mesh.uvs[i].y());
  }
  for (std::size_t part = 0; part < mesh.parts.size(); ++part) {
    text += fmt::format("usemtl part{}\n", part);
    for (std::uint32_t i = 0; i < mesh.parts[part].triangles; ++i) {
      text += "f";
      for (const std::uint32_t vertex : mesh.triangles[mesh.parts[part].first_triangle + i]) {
        text += fmt::format(" {0}/{0}/{0}", vertex + 1);
      }
      text += "\n";
    }
  }
  return text;
}

std::string ObjMaterials(const Mesh& mesh, const std::string& texture_name) {
  std::string text;
  for (std::size_t part = 0; part < mesh.parts.size(); ++part) {
    const Eigen::Vector4f& c = mesh.materials[static_cast<std::size_t>(mesh.parts[part].material)].base_colour;
    text += fmt::format("newmtl part{}\nKd {} {} {}\n", part, c.x(), c.y(), c.z());
    if (!texture_name.empty()) text += "map_Kd " + texture_name + "\n";
  }
  return text;
}

std::string PlyFrom(const Mesh& mesh) {
  const bool coloured = !mesh.colours.empty();
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
      "z\n{}"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.positions.size(), coloured ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "",
      mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    text += Bytes(mesh.positions[i]);
    for (int channel = 0; coloured && channel < 3; ++channel) {
      text.push_back(static_cast<char>(static_cast<std::uint8_t>(255 * mesh.colours[i][channel])));
    }
  }
  for (const auto& triangle : mesh.triangles) text += "\3" + Bytes(triangle);
  return text;
}

std::string StlFrom(const Mesh& mesh) {
  std::string bytes(80, ' ');
  bytes += Bytes(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    bytes += Bytes(mesh.normals[triangle[0]]);
    for (const std::uint32_t vertex : triangle) bytes += Bytes(mesh.positions[vertex]);
    bytes += Bytes(std::uint16_t{0});
  }
  return bytes;
}

std::string StlTextFrom(const Mesh& mesh) {
  std::string text = "solid box\n";
  for (const auto& triangle : mesh.triangles) {
    const Vector3f& n = mesh.normals[triangle[0]];
    text += fmt::format("facet normal {} {} {}\nouter loop\n", n.x(), n.y(), n.z());
    for (const std::uint32_t vertex : triangle) {
      const Vector3f& p = mesh.positions[vertex];
      text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string Ac3dFrom(const Mesh& mesh) {
  std::string text = "AC3Db\n";
  for (const Material& material : mesh.materials) {
    const Eigen::Vector4f& c = material.base_colour;
    text += fmt::format("MATERIAL \"m\" rgb {} {} {} amb 0.2 0.2 0.2 emis 0 0 0 spec 0 0 0 shi 1 trans 0\n", c.x(),
                        c.y(), c.z());
  }
  text += fmt::format("OBJECT world\nkids 1\nOBJECT poly\nname \"box\"\nnumvert {}\n", mesh.positions.size());
  for (const Vector3f& p : mesh.positions) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  text += fmt::format("numsurf {}\n", mesh.triangles.size());
  for (const MeshPart& part : mesh.parts) {
    for (std::uint32_t i = 0; i < part.triangles; ++i) {
      text += fmt::format("SURF 0x20\nmat {}\nrefs 3\n", part.material);
      for (const std::uint32_t vertex : mesh.triangles[part.first_triangle + i]) {
        text += fmt::format("{} {} {}\n", vertex, mesh.uvs[vertex].x(), 1 - mesh.uvs[vertex].y());
      }
    }
  }
  return text + "kids 0\n";
}

std::string ColladaFrom(const Mesh& mesh, const std::string& up_axis, double unit_m) {
  const std::span<const float> numbers(mesh.positions[0].data(), 3 * mesh.positions.size());
  std::vector<std::uint32_t> indices;
  for (const auto& triangle : mesh.triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
  return fmt::format(
      R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="unit" meter="{}"/><up_axis>{}</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p">{}<technique_common>
<accessor source="#pa" count="{}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{}"><input semantic="VERTEX" source="#v" offset="0"/><p>{}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
)",
      unit_m, up_axis, FloatArray("pa", numbers), mesh.positions.size(), mesh.triangles.size(),
      fmt::join(indices, " "));
}

std::string ThreeDsFrom(const Mesh& mesh) {
  constexpr std::uint16_t kMain = 0x4D4D;
  constexpr std::uint16_t kEditor = 0x3D3D;
  constexpr std::uint16_t kObject = 0x4000;
  constexpr std::uint16_t kTriangleMesh = 0x4100;
  constexpr std::uint16_t kVertices = 0x4110;
  constexpr std::uint16_t kFaces = 0x4120;
  std::string faces = Bytes(static_cast<std::uint16_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) faces += Bytes(static_cast<std::uint16_t>(vertex));
    faces += Bytes(std::uint16_t{0});
  }
  const std::string vertices = Bytes(static_cast<std::uint16_t>(mesh.positions.size())) + Bytes(mesh.positions);
  const std::string triangle_mesh = Chunk(kTriangleMesh, Chunk(kVertices, vertices) + Chunk(kFaces, faces));
  const std::string object = Chunk(kObject, std::string("box\0", 4) + triangle_mesh);
  return Chunk(kMain, Chunk(kEditor, object));
}

}  // namespace victorious::testing
