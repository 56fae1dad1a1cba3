#include "victorious/object/mesh/load_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/cad_tools.h"
#include "testing/data.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using testing::GlbExtras;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScratchFolder;

constexpr double kTolerance = 1e-5;

// From the origin to (1, 2, 3): the extents identify each axis and its sign.
Mesh Brick() { return testing::Box({0, 0, 0}, {1, 2, 3}); }

Expected<LoadedMesh> Decode(const std::string& bytes, const std::string& name, const LoadMeshOptions& options = {}) {
  return DecodeMesh(std::as_bytes(std::span(bytes)), name, options);
}

Mesh DecodeOrDie(const std::string& bytes, const std::string& name, const LoadMeshOptions& options = {}) {
  auto loaded = Decode(bytes, name, options);
  EXPECT_TRUE(loaded) << loaded.error().message;
  return loaded ? std::move(loaded->mesh) : Mesh{};
}

void ExpectBox(const Mesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  EXPECT_LT((box.min() - low).norm() + (box.max() - high).norm(), kTolerance)
      << box.min().transpose() << " to " << box.max().transpose();
}

void ExpectOneLineError(const Expected<LoadedMesh>& loaded, const std::string& what) {
  ASSERT_FALSE(loaded) << what;
  EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos) << loaded.error().message;
  EXPECT_THAT(loaded.error().message, HasSubstr(what));
}

// Checks that triangles are counter-clockwise about unit normals that point out of the brick.
void ExpectOutwards(const Mesh& mesh) {
  const Eigen::Vector3f middle = BoundingBox(mesh).center().cast<float>();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f face =
        (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).normalized();
    EXPECT_GT(face.dot(mesh.positions[a] - middle), 0);
    for (const std::uint32_t corner : {a, b, c}) EXPECT_GT(mesh.normals[corner].dot(face), 0.999F);
  }
}

struct FormatCase {
  std::string name;
  std::string bytes;
  bool z_up;
};

std::vector<FormatCase> EveryFormat() {
  const Mesh brick = Brick();
  return {{"brick.glb", testing::GlbFrom(brick), false},
          {"brick.obj", testing::ObjFrom(brick), false},
          {"brick.ac", testing::Ac3dFrom(brick), false},
          {"brick.dae", testing::ColladaFrom(brick), false},
          {"z_up.DAE", testing::ColladaFrom(brick, "Z_UP"), true},
          {"brick.3ds", testing::ThreeDsFrom(brick), true},
          {"brick.ply", testing::PlyFrom(brick), true},
          {"brick.stl", testing::StlFrom(brick), true},
          {"text.stl", testing::StlTextFrom(brick), true}};
}

TEST(LoadMesh, EveryFormatIsConvertedToTheModelFrame) {
  for (const FormatCase& format : EveryFormat()) {
    SCOPED_TRACE(format.name);
    const Mesh mesh = DecodeOrDie(format.bytes, format.name);
    EXPECT_EQ(mesh.triangles.size(), 12);
    ExpectOutwards(mesh);
    if (format.z_up) {
      ExpectBox(mesh, {-2, 0, 0}, {0, 1, 3});  // front -y, left +x, up +z
    } else {
      ExpectBox(mesh, {0, 0, 0}, {3, 1, 2});  // front +z, left +x, up +y
    }
  }
}

TEST(LoadMesh, AxesAreInTheFrameOfTheFile) {
  const LoadMeshOptions options{.up = Axis::kPlusZ, .front = Axis::kPlusX};
  for (const FormatCase& format : EveryFormat()) {
    SCOPED_TRACE(format.name);
    ExpectBox(DecodeOrDie(format.bytes, format.name, options), {0, 0, 0}, {1, 2, 3});
  }
  const std::string obj = testing::ObjFrom(Brick());
  ExpectBox(DecodeOrDie(obj, "a.obj", {.up = Axis::kMinusX}), {0, 0, -1}, {3, 2, 0});
  ExpectOneLineError(Decode(obj, "a.obj", {.up = Axis::kPlusY, .front = Axis::kMinusY}), "two different axes");
}

TEST(LoadMesh, LengthScales) {
  ExpectBox(DecodeOrDie(testing::GlbFrom(Brick()), "a.glb", {.length_m = 6}), {0, 0, 0}, {6, 2, 4});
  const std::string wide = testing::GlbFrom(testing::Box({0, 0, 0}, {8, 1, 2}));
  ExpectBox(DecodeOrDie(wide, "a.glb", {.length_m = 4}), {0, 0, 0}, {4, 16, 2});  // along its front
  ExpectBox(DecodeOrDie(testing::StlFrom(Brick()), "a.stl", {.length_m = 1.5}), {-1, 0, 0}, {0, 0.5, 1.5});
  ExpectOneLineError(Decode(testing::StlFrom(Brick()), "a.stl", {.length_m = -1}), "above 0");
}

TEST(LoadMesh, LengthIsAlongTheGltfFrontElseTheLongestSide) {
  const Mesh wide = testing::Box({0, 0, 0}, {8, 1, 2});
  EXPECT_NEAR(Decode(testing::GlbFrom(wide), "a.glb")->length_m, 2, kTolerance);
  EXPECT_NEAR(Decode(testing::GlbFrom(wide), "a.glb", {.front = Axis::kPlusX})->length_m, 8, kTolerance);
  EXPECT_NEAR(Decode(testing::GlbFrom(wide), "a.glb", {.length_m = 5})->length_m, 5, kTolerance);
  EXPECT_NEAR(Decode(testing::ObjFrom(wide), "a.obj")->length_m, 8, kTolerance);
  EXPECT_NEAR(Decode(testing::ObjFrom(wide), "a.obj", {.length_m = 5})->length_m, 5, kTolerance);
  const Mesh flat = testing::Box({0, 0, 0}, {8, 1, 0});
  EXPECT_NEAR(Decode(testing::GlbFrom(flat), "a.glb")->length_m, 8, kTolerance);
}

TEST(LoadMesh, ColladaUnitIsApplied) {
  ExpectBox(DecodeOrDie(testing::ColladaFrom(Brick(), "Y_UP", 0.01), "a.dae"), {0, 0, 0}, {0.03, 0.01, 0.02});
}

TEST(LoadMesh, NodeTransformsAreApplied) {
  const std::string moved = testing::GlbFrom(Brick(), {.node = R"("translation":[10,20,30],"scale":[2,2,2])"});
  ExpectBox(DecodeOrDie(moved, "a.glb"), {30, 10, 20}, {36, 12, 24});
  const Mesh mirrored = DecodeOrDie(testing::GlbFrom(Brick(), {.node = R"("scale":[-1,1,1])"}), "a.glb");
  ExpectBox(mirrored, {0, -1, 0}, {3, 0, 2});
  ExpectOutwards(mirrored);
}

TEST(LoadMesh, GltfMaterialsAreHonoured) {
  Mesh brick = Brick();
  brick.materials[0].base_colour = {0.25, 0.5, 0.75, 1};
  brick.materials[1].double_sided = true;
  brick.materials[2].alpha_mode = AlphaMode::kMask;
  brick.materials[2].alpha_cutoff = 0.25F;
  brick.materials[3].alpha_mode = AlphaMode::kBlend;
  brick.materials[3].base_colour.w() = 0.5F;
  brick.materials[4].alpha_mode = AlphaMode::kBlend;  // without any transparency
  const Mesh mesh = DecodeOrDie(testing::GlbFrom(brick), "a.glb");
  ASSERT_EQ(mesh.parts.size(), 6);
  const auto material = [&](std::size_t part) {
    return mesh.materials[static_cast<std::size_t>(mesh.parts[part].material)];
  };
  EXPECT_EQ(material(0).base_colour, Eigen::Vector4f(0.25, 0.5, 0.75, 1));
  EXPECT_FALSE(material(0).double_sided);
  EXPECT_TRUE(material(1).double_sided);
  EXPECT_EQ(material(2).alpha_mode, AlphaMode::kMask);
  EXPECT_FLOAT_EQ(material(2).alpha_cutoff, 0.25F);
  EXPECT_EQ(material(3).alpha_mode, AlphaMode::kBlend);
  EXPECT_FLOAT_EQ(material(3).base_colour.w(), 0.5F);
  EXPECT_EQ(material(4).alpha_mode, AlphaMode::kOpaque);
}

TEST(LoadMesh, VertexColoursAreLinearInGltfAndSrgbElsewhere) {
  Mesh brick = Brick();
  brick.colours.assign(brick.positions.size(), {0.5, 0.25, 1, 1});
  const Mesh gltf = DecodeOrDie(testing::GlbFrom(brick), "a.glb");
  ASSERT_EQ(gltf.colours.size(), gltf.positions.size());
  EXPECT_LT((gltf.colours[0] - Eigen::Vector4f(0.5, 0.25, 1, 1)).norm(), kTolerance);
  const Mesh ply = DecodeOrDie(testing::PlyFrom(brick), "a.ply");
  ASSERT_EQ(ply.colours.size(), ply.positions.size());
  EXPECT_LT((ply.colours[0] - Eigen::Vector4f(0.2122F, 0.0497F, 1, 1)).norm(), 1e-3);  // of 127 and 63
  EXPECT_EQ(ply.materials[0].base_colour, Eigen::Vector4f::Ones());
}

// Four different texels: left upper red, right upper green, left lower blue, right lower white.
cv::Mat FourTexels() {
  cv::Mat texture(2, 2, CV_8UC4);
  texture.at<cv::Vec4b>(0, 0) = {0, 0, 255, 255};
  texture.at<cv::Vec4b>(0, 1) = {0, 255, 0, 255};
  texture.at<cv::Vec4b>(1, 0) = {255, 0, 0, 255};
  texture.at<cv::Vec4b>(1, 1) = {255, 255, 255, 255};
  return texture;
}

void ExpectSameTexture(const Mesh& mesh, const cv::Mat& texture) {
  ASSERT_EQ(mesh.textures.size(), 1);
  EXPECT_EQ(cv::norm(mesh.textures[0], texture, cv::NORM_INF), 0);
}

TEST(LoadMesh, EmbeddedTexturesAndCoordinates) {
  const Mesh mesh = DecodeOrDie(testing::GlbFrom(testing::TexturedSquare(FourTexels())), "a.glb");
  ExpectSameTexture(mesh, FourTexels());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(mesh.uvs[i].x(), (mesh.positions[i].y() + 1) / 2, kTolerance);  // left +x of the file
    EXPECT_NEAR(mesh.uvs[i].y(), (1 - mesh.positions[i].z()) / 2, kTolerance);
  }
}

TEST(LoadMesh, TextureTransformsAreApplied) {
  const GlbExtras extras{
      .texture_info =
          R"("extensions":{"KHR_texture_transform":{"offset":[0.25,0.5],"scale":[0.5,0.25],"rotation":0.3}})",
      .top = R"("extensionsUsed":["KHR_texture_transform"])"};
  const Mesh mesh = DecodeOrDie(testing::GlbFrom(testing::TexturedSquare(FourTexels()), extras), "a.glb");
  Eigen::Matrix2d turn;  // as the extension defines it: counter-clockwise with v downwards
  turn << std::cos(0.3), std::sin(0.3), -std::sin(0.3), std::cos(0.3);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Eigen::Vector2d plain((mesh.positions[i].y() + 1) / 2, (1 - mesh.positions[i].z()) / 2);
    const Eigen::Vector2d expected = turn * plain.cwiseProduct(Eigen::Vector2d(0.5, 0.25)) + Eigen::Vector2d(0.25, 0.5);
    EXPECT_LT((mesh.uvs[i].cast<double>() - expected).norm(), kTolerance);
  }
}

TEST(LoadMesh, ObjReadsMaterialsAndTexturesFromItsFolder) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "maps");
  ASSERT_TRUE(cv::imwrite((folder / "maps/t.png").string(), FourTexels()));
  const Mesh square = testing::TexturedSquare(FourTexels());
  std::ofstream(folder / "a.mtl") << testing::ObjMaterials(square, "maps/t.png");
  std::ofstream(folder / "a.obj") << testing::ObjFrom(square, "a.mtl");
  const auto loaded = LoadMesh(folder / "a.obj");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->warnings, IsEmpty());
  ExpectSameTexture(loaded->mesh, FourTexels());
  const Mesh& mesh = loaded->mesh;
  EXPECT_TRUE(mesh.materials[static_cast<std::size_t>(mesh.parts[0].material)].double_sided);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(mesh.uvs[i].y(), (1 - mesh.positions[i].z()) / 2, kTolerance);
  }
}

TEST(LoadMesh, GltfReadsBuffersAndTexturesFromItsFolder) {
  const ScratchFolder folder;
  ASSERT_TRUE(cv::imwrite((folder / "a texture.png").string(), FourTexels()));
  const std::string glb = testing::GlbFrom(testing::TexturedSquare(FourTexels()), {.image_uri = "a%20texture.png"});
  const std::size_t binary = glb.find("BIN") - 4;
  std::string json = glb.substr(20, binary - 20);
  const std::string_view buffers = R"("buffers":[{)";
  json.insert(json.find(buffers) + buffers.size(), R"("uri":"a%20buffer.bin",)");
  std::ofstream(folder / "a buffer.bin", std::ios::binary) << glb.substr(binary + 8);
  std::ofstream(folder / "a.gltf") << json;
  const auto loaded = LoadMesh(folder / "a.gltf");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->warnings, IsEmpty());
  ExpectSameTexture(loaded->mesh, FourTexels());
}

TEST(LoadMesh, AbsoluteTexturePathsAreFoundByFileName) {
  const ScratchFolder folder;
  ASSERT_TRUE(cv::imwrite((folder / "t.bmp").string(), FourTexels()));
  const Mesh square = testing::TexturedSquare(FourTexels());
  std::ofstream(folder / "a.mtl") << testing::ObjMaterials(square, "C:\\work\\tank\\t.bmp");
  std::ofstream(folder / "a.obj") << testing::ObjFrom(square, "a.mtl");
  const auto loaded = LoadMesh(folder / "a.obj");
  ASSERT_TRUE(loaded) << loaded.error().message;
  ExpectSameTexture(loaded->mesh, FourTexels());
}

TEST(LoadMesh, ReadsTga) {
  const ScratchFolder folder;
  const auto tga = [](std::string head, const std::string& pixels) { return std::move(head) + pixels; };
  const std::string bottom_up("\0\0\x02\0\0\0\0\0\0\0\0\0\x02\0\x02\0\x18\0", 18);
  const std::string runs_top_down("\0\0\x0A\0\0\0\0\0\0\0\0\0\x02\0\x02\0\x18\x20", 18);
  const std::string red("\0\0\xFF", 3);
  const std::string green("\0\xFF\0", 3);
  const std::string blue("\xFF\0\0", 3);
  const std::string white("\xFF\xFF\xFF", 3);
  const Mesh square = testing::TexturedSquare(FourTexels());
  std::ofstream(folder / "a.mtl") << testing::ObjMaterials(square, "t.tga");
  std::ofstream(folder / "a.obj") << testing::ObjFrom(square, "a.mtl");
  std::ofstream(folder / "t.tga", std::ios::binary) << tga(bottom_up, blue + white + red + green);
  ExpectSameTexture(LoadMesh(folder / "a.obj")->mesh, FourTexels());
  std::ofstream(folder / "t.tga", std::ios::binary)
      << tga(runs_top_down, "\x01" + red + green + "\x80" + blue + "\x80" + white);
  ExpectSameTexture(LoadMesh(folder / "a.obj")->mesh, FourTexels());
}

TEST(LoadMesh, MissingAndUnsupportedTexturesAreSkippedWithAWarning) {
  const ScratchFolder outer;
  const std::filesystem::path folder = outer / "model";
  std::filesystem::create_directory(folder);
  ASSERT_TRUE(cv::imwrite((outer / "secret.png").string(), FourTexels()));
  std::filesystem::create_symlink(outer / "secret.png", folder / "link.png");
  std::ofstream(folder / "text.png") << "not an image";
  for (const std::string uri : {"missing.png", "../secret.png", "link.png", "text.png", "/etc/passwd", "."}) {
    SCOPED_TRACE(uri);
    std::ofstream(folder / "a.glb", std::ios::binary)
        << testing::GlbFrom(testing::TexturedSquare(FourTexels()), {.image_uri = uri});
    const auto loaded = LoadMesh(folder / "a.glb");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_THAT(loaded->warnings, ElementsAre(HasSubstr("texture left out")));
    EXPECT_THAT(loaded->mesh.textures, IsEmpty());
    EXPECT_EQ(loaded->mesh.materials[0].texture, -1);
  }
}

TEST(LoadMesh, MissingNormalsAreSmoothButSharpAtEdges) {
  Mesh brick = Brick();
  brick.normals.clear();
  ExpectOutwards(DecodeOrDie(testing::GlbFrom(brick), "a.glb"));

  // A cylinder wall of 24 sides, 15 degrees each, with shared vertices.
  Mesh wall;
  constexpr int kSides = 24;
  for (int i = 0; i < kSides; ++i) {
    const float angle = static_cast<float>(2 * M_PI * i / kSides);
    for (const float y : {0.0F, 1.0F}) wall.positions.emplace_back(std::sin(angle), y, std::cos(angle));
    const auto a = static_cast<std::uint32_t>(2 * i);
    const auto b = static_cast<std::uint32_t>(2 * ((i + 1) % kSides));
    wall.triangles.push_back({a, b, b + 1});
    wall.triangles.push_back({a, b + 1, a + 1});
  }
  wall.parts = {{0, 0, 2 * kSides}};
  wall.materials.resize(1);
  const Mesh mesh = DecodeOrDie(testing::GlbFrom(wall), "a.glb");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const Eigen::Vector3f& p = mesh.positions[corner];
      EXPECT_GT(mesh.normals[corner].dot(Eigen::Vector3f(p.x(), p.y(), 0)), 0.995F);
    }
  }
}

TEST(LoadMesh, DamagedTrianglesAreSkipped) {
  Mesh brick = Brick();
  brick.positions[0].x() = std::numeric_limits<float>::quiet_NaN();
  brick.positions[4].y() = std::numeric_limits<float>::infinity();
  const auto loaded = Decode(testing::StlFrom(brick), "a.stl");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->mesh.triangles.size(), 8);
  EXPECT_THAT(loaded->warnings, ElementsAre(HasSubstr("4 triangles left out")));
  for (Eigen::Vector3f& position : brick.positions) position.x() = std::numeric_limits<float>::quiet_NaN();
  ExpectOneLineError(Decode(testing::StlFrom(brick), "a.stl"), "a.stl: no triangle");
}

TEST(LoadMesh, ErrorsOfInvalidFilesAreOneLine) {
  ExpectOneLineError(Decode("", "a.glb"), "a.glb");
  ExpectOneLineError(Decode("hello", "a.glb"), "a.glb");
  ExpectOneLineError(Decode("hello", "a.txt"), "not a CAD file");
  ExpectOneLineError(Decode("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj"), "a.obj");
  ExpectOneLineError(Decode("v 1 1 1\nf 1 1 1\n", "a.obj"), "one point");
  ExpectOneLineError(Decode("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 7 8 9\n", "a.obj"), "a.obj");
  ExpectOneLineError(LoadMesh("no/such/file.glb"), "no/such/file.glb");
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "a.glb");
  ExpectOneLineError(LoadMesh(folder / "a.glb"), "a.glb");
  Mesh far = Brick();
  for (Eigen::Vector3f& position : far.positions) position *= 1e20F;
  ExpectOneLineError(Decode(testing::StlFrom(far), "a.stl"), "length may be given");
}

TEST(LoadMesh, TruncatedFilesGiveErrorsOrFewerTriangles) {
  for (const FormatCase& format : EveryFormat()) {
    SCOPED_TRACE(format.name);
    for (int tenths = 1; tenths < 10; ++tenths) {
      const auto loaded =
          Decode(format.bytes.substr(0, format.bytes.size() * static_cast<std::size_t>(tenths) / 10), format.name);
      if (loaded) {
        EXPECT_LE(loaded->mesh.triangles.size(), 12);
      } else {
        EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
      }
    }
  }
}

TEST(LoadMesh, ErrorsOfMaliciousGltfAreOneLine) {
  const std::string head = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)";
  const std::string mesh =
      R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)";
  const auto glb = [&](const std::string& rest) {
    return testing::GlbFromChunks(head + rest + "}", std::string(64, '\1'));
  };
  const auto accessors = [](const std::string& positions, const std::string& indices, const std::string& buffer) {
    return fmt::format(R"("accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3",{}}},)"
                       R"({{"bufferView":0,"componentType":5125,"type":"SCALAR",{}}}],)"
                       R"("bufferViews":[{{"buffer":0,{}}}],"buffers":[{{{}}}])",
                       positions, indices, buffer, buffer);
  };
  const std::string fine = R"("byteLength":64)";
  // Counts beyond the buffer, buffers beyond memory, indices beyond the vertices.
  EXPECT_FALSE(Decode(glb(mesh + accessors(R"("count":4000000000)", R"("count":3)", fine)), "a.glb"));
  EXPECT_FALSE(Decode(glb(mesh + accessors(R"("count":3)", R"("count":4000000000)", fine)), "a.glb"));
  EXPECT_FALSE(
      Decode(glb(mesh + accessors(R"("count":3)", R"("count":3)", R"("byteLength":9000000000000000000)")), "a.glb"));
  EXPECT_FALSE(Decode(glb(mesh + accessors(R"("count":3)", R"("count":3)", fine)), "a.glb"));
  // A node that is its own child; JSON a million deep.
  EXPECT_FALSE(Decode(glb(R"("nodes":[{"children":[0]}])"), "a.glb"));
  EXPECT_FALSE(Decode(glb(R"("extras":)" + std::string(1'000'000, '[')), "a.glb"));
  // A mesh of 12 triangles placed 400,000 times.
  std::string nodes = R"({"mesh":0})";
  for (int i = 1; i < 400'000; ++i) nodes += R"(,{"mesh":0})";
  const std::string many = testing::GlbFrom(Brick());
  const std::string one = R"([{"mesh":0}])";
  const std::size_t json = 20;
  const std::size_t binary = many.find("BIN") - 4;
  std::string text = many.substr(json, binary - json);
  text.replace(text.find(one), one.size(), "[" + nodes + "]");
  std::string all = "0";
  for (int i = 1; i < 400'000; ++i) all += fmt::format(",{}", i);
  text.replace(text.find(R"("nodes":[0])"), 11, R"("nodes":[)" + all + "]");
  ExpectOneLineError(Decode(testing::GlbFromChunks(text, many.substr(binary + 8)), "a.glb"), "a.glb");
}

TEST(LoadMesh, TooManyTrianglesAreRefused) {
  constexpr std::uint32_t kTriangles = 5'000'000;
  const Mesh mesh = Brick();
  std::string bytes = testing::StlFrom(mesh).substr(0, 84 + 50);
  std::memcpy(bytes.data() + 80, &kTriangles, sizeof kTriangles);
  bytes.reserve(84 + std::size_t{50} * kTriangles);
  while (bytes.size() < 84 + std::size_t{50} * kTriangles) {
    bytes.append(bytes, 84, std::min(bytes.size() - 84, 84 + std::size_t{50} * kTriangles - bytes.size()));
  }
  ExpectOneLineError(Decode(bytes, "a.stl"), "a.stl: ");
}

TEST(ParseAxis, NamesAndSigns) {
  EXPECT_EQ(ParseAxis("z"), Axis::kPlusZ);
  EXPECT_EQ(ParseAxis("-X"), Axis::kMinusX);
  EXPECT_EQ(ParseAxis("+y"), Axis::kPlusY);
  for (const char* wrong : {"", "w", "-", "xx", "--x"}) EXPECT_FALSE(ParseAxis(wrong)) << wrong;
}

}  // namespace
}  // namespace victorious
