#include "victorious/object/mesh/mesh_bytes.h"

#include <limits>

#include <gtest/gtest.h>

#include "testing/cad_tools.h"

namespace victorious {
namespace {

LoadedMesh Loaded() {
  return {.mesh = testing::Box({-1, -1, -1}, {1, 1, 1}), .length_m = 2, .warnings = {"a warning"}};
}

TEST(MeshBytes, RoundTrip) {
  const LoadedMesh loaded = Loaded();
  const auto back = MeshFromBytes(BytesFromMesh(loaded));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->mesh.positions, loaded.mesh.positions);
  EXPECT_EQ(back->mesh.triangles, loaded.mesh.triangles);
  EXPECT_EQ(back->warnings, loaded.warnings);
}

// Bytes that an import process under the control of a hostile file could write.
TEST(MeshBytes, RefusesInvalidMeshes) {
  const auto refused = [](const auto& spoil) {
    LoadedMesh loaded = Loaded();
    spoil(loaded.mesh);
    return !MeshFromBytes(BytesFromMesh(loaded)).has_value();
  };
  EXPECT_FALSE(refused([](Mesh&) {}));
  EXPECT_TRUE(refused([](Mesh& mesh) { mesh.triangles[0][1] = 1000; }));
  EXPECT_TRUE(
      refused([](Mesh& mesh) { mesh.positions[mesh.triangles[0][0]].x() = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](Mesh& mesh) { mesh.materials[0].alpha_mode = static_cast<AlphaMode>(7); }));
  EXPECT_TRUE(refused([](Mesh& mesh) { mesh.materials[0].wrap_u = static_cast<TextureWrap>(9); }));
  EXPECT_TRUE(refused([](Mesh& mesh) { mesh.materials[0].texture = 3; }));
  EXPECT_TRUE(refused([](Mesh& mesh) { mesh.normals.pop_back(); }));
}

}  // namespace
}  // namespace victorious
