#include "victorious/object/mesh/readable_file.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/cad_tools.h"
#include "testing/data.h"

namespace victorious {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kReadTolerance = 1e-4;

Expected<LoadedMesh> DecodeFile(const std::string& bytes, const std::string& name) {
  return DecodeMesh(std::as_bytes(std::span(bytes)), name);
}

Eigen::Vector3d SizeOf(const Expected<LoadedMesh>& loaded) {
  EXPECT_TRUE(loaded) << loaded.error().message;
  return loaded ? Eigen::Vector3d(BoundingBox(loaded->mesh).sizes()) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

// A glTF file of one body with the corners (0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4): in the model frame 4 long, 2
// wide, 3 high.
class Gltf {
 public:
  Gltf() {
    Put<std::uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    const std::size_t indices = Accessor(5123, "SCALAR", 12);
    root = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", json::object()}, {"indices", indices}}}}}}}};
  }

  template <typename T>
  std::size_t Add(int component, const std::string& type, const std::vector<T>& numbers, bool normalised = false) {
    const std::size_t components = type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    Put(numbers);
    const std::size_t index = Accessor(component, type, numbers.size() / components);
    if (normalised) accessors_[index]["normalized"] = true;
    return index;
  }
  template <typename T>
  void AddPositions(int component, T unit, bool normalised = false) {
    std::vector<T> numbers;
    for (const int number : {0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4}) numbers.push_back(static_cast<T>(number * unit));
    attributes()["POSITION"] = Add(component, "VEC3", numbers, normalised);
  }

  json& attributes() { return root["meshes"][0]["primitives"][0]["attributes"]; }

  std::string Bytes() {
    root["bufferViews"] = views_;
    root["accessors"] = accessors_;
    root["buffers"] = {{{"byteLength", binary_.size()}}};
    return testing::GlbFromChunks(root.dump(), binary_);
  }

  json root;

 private:
  template <typename T>
  void Put(const std::vector<T>& numbers) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    views_.push_back({{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", numbers.size() * sizeof(T)}});
    binary_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
  }
  std::size_t Accessor(int component, const std::string& type, std::size_t count) {
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors_.size() - 1;
  }

  json views_ = json::array();
  json accessors_ = json::array();
  std::string binary_;
};

const Eigen::Vector3d kSize(4, 2, 3);

TEST(ReadableGltf, QuantisedPositions) {
  Gltf millimetres;
  millimetres.AddPositions<std::int16_t>(5122, 1000);
  millimetres.root["nodes"][0]["scale"] = {0.001, 0.001, 0.001};
  millimetres.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_LT((SizeOf(DecodeFile(millimetres.Bytes(), "a.glb")) - kSize).norm(), kReadTolerance);

  Gltf normalised;
  normalised.AddPositions<std::int16_t>(5122, 8191, true);
  normalised.root["nodes"][0]["scale"] = {4, 4, 4};
  EXPECT_LT((SizeOf(DecodeFile(normalised.Bytes(), "a.glb")) - kSize).norm(), 1e-3);
}

TEST(ReadableGltf, NormalisedTextureCoordinates) {
  Gltf gltf;
  gltf.AddPositions<float>(5126, 1);
  gltf.attributes()["TEXCOORD_0"] = gltf.Add<std::uint16_t>(5123, "VEC2", {0, 0, 65535, 0, 0, 65535, 0, 0}, true);
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.root["textures"] = {{{"source", 0}}};
  gltf.root["images"] = {{{"uri", "none.png"}}};
  gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
  const auto loaded = DecodeFile(gltf.Bytes(), "a.glb");
  ASSERT_TRUE(loaded);
  EXPECT_THAT(loaded->mesh.uvs, Contains(Eigen::Vector2f(1, 0)));
  EXPECT_THAT(loaded->mesh.uvs, Contains(Eigen::Vector2f(0, 1)));
}

// glTF 2.0, 3.7.3.2: the node's own transform does not count, only those of the joints.
TEST(ReadableGltf, SkinsAreAppliedAtRest) {
  Gltf gltf;
  gltf.AddPositions<float>(5126, 1);
  gltf.attributes()["JOINTS_0"] = gltf.Add<std::uint8_t>(5121, "VEC4", std::vector<std::uint8_t>(16, 0));
  gltf.attributes()["WEIGHTS_0"] = gltf.Add<float>(5126, "VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"scale", {0.01, 0.01, 0.01}}}, {{"scale", {2, 2, 2}}}};
  gltf.root["scenes"][0]["nodes"] = {0, 1};
  gltf.root["skins"] = {{{"joints", {1}}}};
  EXPECT_LT((SizeOf(DecodeFile(gltf.Bytes(), "a.glb")) - 2 * kSize).norm(), kReadTolerance);
}

TEST(ReadableGltf, MorphTargetsHaveTheirDefaultWeights) {
  Gltf gltf;
  gltf.AddPositions<float>(5126, 1);
  const std::size_t target = gltf.Add<float>(5126, "VEC3", {0, 0, 0, 0, 0, 0, 0, 6, 0, 0, 0, 0});
  gltf.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  gltf.root["meshes"][0]["weights"] = {0.5};
  EXPECT_LT((SizeOf(DecodeFile(gltf.Bytes(), "a.glb")) - Eigen::Vector3d(4, 2, 6)).norm(), kReadTolerance);
  gltf.root["nodes"][0]["weights"] = {1.0};
  EXPECT_LT((SizeOf(DecodeFile(gltf.Bytes(), "a.glb")) - Eigen::Vector3d(4, 2, 9)).norm(), kReadTolerance);
}

TEST(ReadableGltf, InstancesAreDrawnAndNotTheMeshItself) {
  Gltf gltf;
  gltf.AddPositions<float>(5126, 1);
  const std::size_t places = gltf.Add<float>(5126, "VEC3", {100, 0, 0, 110, 0, 0});
  gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = places;
  gltf.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const auto loaded = DecodeFile(gltf.Bytes(), "a.glb");
  EXPECT_LT((SizeOf(loaded) - Eigen::Vector3d(4, 12, 3)).norm(), kReadTolerance);
  EXPECT_EQ(loaded->mesh.triangles.size(), 8U);
}

TEST(ReadableGltf, MapCoordinatesOfNodesLoseNothing) {
  Gltf gltf;
  gltf.AddPositions<float>(5126, 1);
  gltf.root["nodes"][0]["translation"] = {2600012.3, 0, 1200035.7};
  EXPECT_LT((SizeOf(DecodeFile(gltf.Bytes(), "a.glb")) - kSize).norm(), kReadTolerance);
}

TEST(ReadableGltf, AnExtensionThatIsRequiredAndNotReadIsNamed) {
  Gltf gltf;
  gltf.AddPositions<float>(5126, 1);
  gltf.root["extensionsRequired"] = {"EXAMPLE_not_known"};
  const auto loaded = DecodeFile(gltf.Bytes(), "a.glb");
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("EXAMPLE_not_known"));

  Gltf images;
  images.AddPositions<float>(5126, 1);
  images.root["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  const auto with_warning = DecodeFile(images.Bytes(), "a.glb");
  ASSERT_TRUE(with_warning);
  EXPECT_THAT(with_warning->warnings, Contains(HasSubstr("EXT_texture_webp")));
  images.root["extensionsRequired"] = {"EXT_texture_webp"};
  EXPECT_FALSE(DecodeFile(images.Bytes(), "a.glb"));
}

// Whatever its numbers say, a file is read or refused.
TEST(ReadableGltf, DamagedNumbersAreNoCrash) {
  for (const char* key : {"bufferView", "count", "componentType"}) {
    Gltf gltf;
    gltf.AddPositions<std::int16_t>(5122, 1000);
    gltf.root["skins"] = {{{"joints", {7, 99}}}};
    gltf.root["nodes"][0]["skin"] = 0;
    gltf.root["nodes"][0]["children"] = {0};
    std::string bytes = gltf.Bytes();
    const std::string text = fmt::format("\"{}\":", key);
    for (std::size_t at = bytes.find(text); at != std::string::npos; at = bytes.find(text, at + 1))
      bytes[at + text.size()] = '9';
    const auto loaded = DecodeFile(bytes, "a.glb");
    EXPECT_TRUE(loaded || loaded.error().message.find('\n') == std::string::npos) << key;
  }
}

std::string Obj(double east, double north, const std::string& first = "") {
  std::string text = first;
  for (const auto& [x, y, z] : std::to_array<std::array<double, 3>>({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}}))
    text += fmt::format("v {:.3f} {:.3f} {:.3f}\n", east + x, y, north + z);
  return text + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

TEST(ReadableObj, MapCoordinatesLoseNothing) {
  for (const auto& [east, north] : std::to_array<std::pair<double, double>>({{530012, 180035}, {2600012, 1200035}}))
    EXPECT_LT((SizeOf(DecodeFile(Obj(east, north), "a.obj")) - kSize).norm(), 1e-3);
}

TEST(ReadableObj, AMaterialFileThatIsNotThereIsSaid) {
  const std::string bytes = "\xEF\xBB\xBFmtllib not_there.mtl\n" + Obj(0, 0);
  const auto loaded = DecodeFile(bytes, "a.obj");
  ASSERT_TRUE(loaded);
  EXPECT_THAT(loaded->warnings, Contains(HasSubstr("not_there.mtl: no such file")));
  EXPECT_THAT(DecodeFile(Obj(0, 0), "a.obj")->warnings, IsEmpty());
}

TEST(ReadableObj, NamesInAnotherCaseAreFound) {
  const testing::ScratchFolder folder;
  std::ofstream(folder.path() / "Paint.mtl") << "newmtl red\nKd 1 0 0\n";
  std::ofstream(folder.path() / "a.obj") << "mtllib PAINT.MTL\nusemtl red\n" << Obj(0, 0);
  const auto loaded = LoadMesh(folder.path() / "a.obj");
  ASSERT_TRUE(loaded);
  EXPECT_THAT(loaded->warnings, IsEmpty());
  EXPECT_EQ(loaded->mesh.materials[static_cast<std::size_t>(loaded->mesh.parts[0].material)].base_colour,
            Eigen::Vector4f(1, 0, 0, 1));
  std::ofstream(folder.path() / "PAINT.mtl") << "newmtl red\nKd 0 1 0\n";
  EXPECT_THAT(LoadMesh(folder.path() / "a.obj")->warnings, Contains(HasSubstr("no such file"))) << "two are meant";
}

TEST(ReadableObj, AnInvisibleObjectIsOpaque) {
  const testing::ScratchFolder folder;
  std::ofstream(folder.path() / "a.mtl") << "newmtl red\nKd 1 0 0\nTr 1\n";
  std::ofstream(folder.path() / "a.obj") << "mtllib a.mtl\nusemtl red\n" << Obj(0, 0);
  const auto loaded = LoadMesh(folder.path() / "a.obj");
  ASSERT_TRUE(loaded);
  EXPECT_THAT(loaded->warnings, Contains(HasSubstr("taken as opaque")));
  EXPECT_EQ(loaded->mesh.materials[static_cast<std::size_t>(loaded->mesh.parts[0].material)].base_colour.w(), 1);
}

TEST(ReadableObj, VertexColoursMayBeBytes) {
  const std::string bytes = "v 0 0 0 255 0 0\nv 1 0 0 255 0 0\nv 0 1 0 255 0 0\nf 1 2 3\n";
  const auto loaded = DecodeFile(bytes, "a.obj");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->mesh.colours.at(0), Eigen::Vector4f(1, 0, 0, 1));
  const std::string half = "v 0 0 0 127 127 127\nv 1 0 0 127 127 127\nv 0 1 0 127 127 127\nf 1 2 3\n";
  EXPECT_NEAR(DecodeFile(half, "a.obj")->mesh.colours.at(0).x(), 0.212, 1e-3);
}

// A binary triangle; `low` is the first byte of its data.
std::string Ply(char low, const std::string& properties = "") {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
      properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::array<float, 3> vertex : {std::array<float, 3>{1, 0, 0}, {3, 0, 0}, {1, 4, 0}}) {
    bytes.append(reinterpret_cast<const char*>(vertex.data()), sizeof(vertex));
    if (!properties.empty()) bytes.append("\xFF\0\0", 3);
  }
  bytes[bytes.find("end_header\n") + std::string("end_header\n").size()] = low;
  bytes.push_back(3);
  for (const std::int32_t corner : {0, 1, 2}) bytes.append(reinterpret_cast<const char*>(&corner), sizeof(corner));
  return bytes;
}

TEST(ReadablePly, DataMayBeginWithALineFeed) {
  for (const char low : {'\x0A', '\x0B', '\x0D'}) {
    const auto loaded = DecodeFile(Ply(low), "a.ply");
    EXPECT_LT((SizeOf(loaded) - Eigen::Vector3d(4, 2, 0)).norm(), 1e-3) << int{low};
  }
}

TEST(ReadablePly, DiffuseColoursAreColours) {
  const auto loaded = DecodeFile(
      Ply(0, "property uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar diffuse_blue\n"), "a.ply");
  ASSERT_TRUE(loaded);
  ASSERT_FALSE(loaded->mesh.colours.empty());
  EXPECT_EQ(loaded->mesh.colours[0], Eigen::Vector4f(1, 0, 0, 1));
}

TEST(ReadablePly, APointCloudIsNamed) {
  const auto loaded = DecodeFile("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "a.ply");
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("a point cloud"));
}

}  // namespace
}  // namespace victorious
