// Tests the shipped models and town assets in assets/ with a reader that shares no code with their writer.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "assets/make/asset.h"
#include "assets/make/catalogue.h"
#include "assets/make/ground.h"
#include "assets/make/unwrap.h"
#include "victorious/base/file.h"

namespace victorious::assets {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kFolder = fs::path(VICTORIOUS_SOURCE_DIR) / "assets";

struct Read {
  std::vector<Vec3> positions, normals;
  std::vector<Eigen::Vector2f> uvs;
  std::vector<std::uint32_t> indices;
  cv::Mat texture;
  Vec3 least, greatest;
};

std::uint32_t Word(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Reads the subset of glTF 2.0, chapter "GLB File Format", that these files use.
class GlbReader {
 public:
  explicit GlbReader(const std::string& bytes) : bytes_(bytes) {
    if (Word(bytes, 0) != 0x46546C67 || Word(bytes, 4) != 2) throw std::runtime_error("no GLB 2.0");
    if (Word(bytes, 8) != bytes.size()) throw std::runtime_error("wrong length");
    const std::uint32_t json_size = Word(bytes, 12);
    document_ = json::parse(bytes.substr(20, json_size));
    binary_ = 20 + json_size + 8;
    if (binary_ + Word(bytes, 20 + json_size) != bytes.size()) throw std::runtime_error("wrong binary length");
  }

  Read Mesh() const {
    Read mesh;
    const json& primitive = document_.at("meshes").at(0).at("primitives").at(0);
    mesh.positions = Values<Vec3>(primitive.at("attributes").at("POSITION"));
    mesh.normals = Values<Vec3>(primitive.at("attributes").at("NORMAL"));
    mesh.uvs = Values<Eigen::Vector2f>(primitive.at("attributes").at("TEXCOORD_0"));
    const int indices = primitive.at("indices");
    if (document_.at("accessors").at(indices).at("componentType") == 5123) {
      const auto narrow = Values<std::uint16_t>(indices);
      mesh.indices.assign(narrow.begin(), narrow.end());
    } else {
      mesh.indices = Values<std::uint32_t>(indices);
    }
    const std::string image = View(document_.at("images").at(0).at("bufferView"));
    mesh.texture = cv::imdecode(std::vector<unsigned char>(image.begin(), image.end()), cv::IMREAD_COLOR);
    mesh.least = mesh.greatest = mesh.positions.at(0);
    for (const Vec3& position : mesh.positions) {
      mesh.least = mesh.least.cwiseMin(position);
      mesh.greatest = mesh.greatest.cwiseMax(position);
    }
    return mesh;
  }

 private:
  [[nodiscard]] std::string View(int index) const {
    const json& view = document_.at("bufferViews").at(index);
    return bytes_.substr(binary_ + view.at("byteOffset").get<std::size_t>(), view.at("byteLength"));
  }

  template <typename T>
  [[nodiscard]] std::vector<T> Values(int accessor) const {
    const json& described = document_.at("accessors").at(accessor);
    const std::string raw = View(described.at("bufferView"));
    std::vector<T> values(described.at("count").get<std::size_t>());
    if (raw.size() != values.size() * sizeof(T)) throw std::runtime_error("accessor and view disagree");
    std::memcpy(static_cast<void*>(values.data()), raw.data(), raw.size());
    return values;
  }

  const std::string& bytes_;
  json document_;
  std::size_t binary_ = 0;
};

std::vector<fs::path> GlbFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".glb") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

Read ReadGlb(const fs::path& path) {
  const auto bytes = ReadFile(path);
  if (!bytes) throw std::runtime_error(bytes.error().message);
  return GlbReader(*bytes).Mesh();
}

/// The width of the vertices in a range of the length (fractions from the front), relative to the model's width.
float WidthWithin(const Read& mesh, float from, float to) {
  const float length = mesh.greatest.z() - mesh.least.z();
  float half = 0;
  for (const Vec3& p : mesh.positions) {
    const float behind = (mesh.greatest.z() - p.z()) / length;
    if (from <= behind && behind <= to) half = std::max(half, std::abs(p.x()));
  }
  return 2 * half / (mesh.greatest.x() - mesh.least.x());
}

TEST(ShippedAssets, EveryGlbIsWellFormed) {
  const std::vector<fs::path> files = GlbFiles(kFolder);
  ASSERT_GE(files.size(), 14U + 9 + 4 + 8 + 13);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    const Read mesh = ReadGlb(file);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    EXPECT_EQ(mesh.indices.size() % 3, 0U);
    EXPECT_LT(*std::ranges::max_element(mesh.indices), mesh.positions.size());
    EXPECT_TRUE(std::ranges::all_of(mesh.normals, [](const Vec3& n) { return std::abs(n.norm() - 1) < 1e-4F; }));
    EXPECT_TRUE(std::ranges::all_of(
        mesh.uvs, [](const Eigen::Vector2f& uv) { return uv.minCoeff() >= 0 && uv.maxCoeff() <= 1; }));
    EXPECT_FALSE(mesh.texture.empty());
  }
}

TEST(ShippedAssets, StandOnTheGroundAtTheOrigin) {
  for (const fs::path& file : GlbFiles(kFolder)) {
    SCOPED_TRACE(file.string());
    const Read mesh = ReadGlb(file);
    EXPECT_NEAR(mesh.least.y(), 0, 1e-3);
    EXPECT_NEAR(mesh.least.x() + mesh.greatest.x(), 0, 2e-3);
    EXPECT_NEAR(mesh.least.z() + mesh.greatest.z(), 0, 2e-3);
  }
}

TEST(ShippedAssets, ReadmeListsSizeAndTrianglesOfEveryModel) {
  const auto readme = ReadFile(kFolder / "README.md");
  ASSERT_TRUE(readme);
  for (const fs::path& file : GlbFiles(kFolder / "models")) {
    const Read mesh = ReadGlb(file);
    const Vec3 size = mesh.greatest - mesh.least;
    const std::size_t triangles = mesh.indices.size() / 3;
    EXPECT_THAT(*readme,
                ::testing::HasSubstr(fmt::format("| `{}` | {:.1f} x {:.1f} x {:.1f} | {} |", file.stem().string(),
                                                 size.z(), size.x(), size.y(), triangles)));
    EXPECT_GE(triangles, 1500U) << file;
    EXPECT_LE(triangles, 15000U) << file;
  }
}

TEST(ShippedAssets, FrontIsAlongZ) {
  // The thin end is in front (gun, nose, boom). The jet's tail is broad, the helicopter's is not.
  EXPECT_LT(WidthWithin(ReadGlb(kFolder / "models/tank.glb"), 0, 0.2F), 0.2F);
  EXPECT_LT(WidthWithin(ReadGlb(kFolder / "models/jet.glb"), 0, 0.25F), 0.2F);
  EXPECT_LT(WidthWithin(ReadGlb(kFolder / "models/excavator.glb"), 0, 0.4F), 0.6F);
  EXPECT_LT(WidthWithin(ReadGlb(kFolder / "models/helicopter.glb"), 0.85F, 1), 0.4F);
}

TEST(ShippedAssets, TotalSizeIsSmall) {
  std::uintmax_t bytes = 0;
  for (const char* const part : {"models", "town"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kFolder / part)) {
      if (entry.is_regular_file()) bytes += entry.file_size();
    }
  }
  EXPECT_LT(bytes, 12'000'000U);
}

TEST(MakeAssets, IsDeterministic) {
  const auto& catalogue = Catalogue();
  const auto crates = std::ranges::find(catalogue, "town/props/crates", &Entry::path);
  ASSERT_NE(crates, catalogue.end());
  const auto once = GlbBytes("crates", BuildTexturedMesh(crates->make()));
  const auto again = GlbBytes("crates", BuildTexturedMesh(crates->make()));
  ASSERT_TRUE(once);
  ASSERT_TRUE(again);
  EXPECT_EQ(*once, *again);
}

TEST(Mesh, SolidsHaveOutwardNormals) {
  const auto volume = [](const Mesh& mesh) {
    float sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) sum += mesh.points[a].dot(mesh.points[b].cross(mesh.points[c])) / 6;
    return sum;
  };
  EXPECT_NEAR(volume(Box({5, 1, 2}, {1, 2, 3}, 0)), 6, 1e-3);
  EXPECT_NEAR(volume(Mirrored(Box({5, 1, 2}, {1, 2, 3}, 0))), 6, 1e-3);
  EXPECT_NEAR(volume(Cylinder({0, 0, 1}, {0, 0, 3}, 1, 64)), 2 * 3.1416, 0.02);
  // An L is concave: its caps need ear clipping.
  const Polygon letter = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) EXPECT_NEAR(volume(Extrude(letter, axis, -1, 1)), 6, 1e-4);
}

TEST(Unwrap, ChartsDoNotOverlap) {
  Asset asset;
  asset.Add("box", Box({0, 0, 0}, {1, 2, 3}), Coat(Rgb(1, 2, 3)));
  asset.Add("ball", Ball({0, 3, 0}, {1, 1, 1}), Coat(Rgb(1, 2, 3)));
  const std::vector<Chart> charts = UnwrapParts(asset.parts, 256).charts;
  ASSERT_EQ(charts.size(), 12U);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    EXPECT_EQ(charts[i].place & cv::Rect(0, 0, 256, 256), charts[i].place);
    for (std::size_t j = 0; j < i; ++j) EXPECT_EQ((charts[i].place & charts[j].place).area(), 0);
  }
}

TEST(Ground, MaterialsTileSeamlessly) {
  for (const Material& material : {Material(Asphalt), Material(Grass), Material(Gravel), Material(Dirt)}) {
    const Bgr here = material(0.01F, 7.3F, 20);
    const Bgr there = material(20.01F, 7.3F, 20);
    EXPECT_NEAR(cv::norm(here - there), 0, 2);
  }
}

}  // namespace
}  // namespace victorious::assets
