// Fuzzes the CAD file readers; the first byte selects the format.
#include <algorithm>
#include <array>
#include <span>
#include <string>

#include <opencv2/core.hpp>

#include "testing/cad_tools.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/object/mesh/load_mesh.h"

namespace {

constexpr std::array kNames = {"a.glb", "a.obj", "a.ply", "a.stl", "a.ac", "a.dae", "a.3ds"};

void CheckMesh(const victorious::Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  VICTORIOUS_CHECK(!mesh.triangles.empty() && mesh.triangles.size() <= victorious::kMaxTriangles);
  VICTORIOUS_CHECK(mesh.normals.size() == vertices && mesh.uvs.size() == vertices);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      VICTORIOUS_CHECK(corner < vertices && mesh.positions[corner].allFinite() && mesh.normals[corner].allFinite());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto loaded = victorious::DecodeMesh(bytes.subspan(1), kNames[data[0] % kNames.size()]);
  if (loaded) {
    CheckMesh(loaded->mesh);
  } else {
    VICTORIOUS_CHECK(loaded.error().message.find('\n') == std::string::npos);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  namespace made = victorious::testing;
  victorious::Mesh box = made::Box({0, 0, 0}, {1, 2, 3});
  box.colours.assign(box.positions.size(), {1, 0.5, 0, 1});
  const std::array seeds = {made::GlbFrom(box),  made::ObjFrom(box),     made::PlyFrom(box),    made::StlFrom(box),
                            made::Ac3dFrom(box), made::ColladaFrom(box), made::ThreeDsFrom(box)};
  std::vector<std::string> marked;
  marked.reserve(seeds.size() + 2);
  for (std::size_t i = 0; i < seeds.size(); ++i) marked.push_back(static_cast<char>(i) + seeds[i]);
  marked.push_back(std::string(1, '\0') +
                   made::GlbFrom(made::TexturedSquare(cv::Mat(4, 4, CV_8UC4, cv::Scalar(9, 8, 7, 255)))));
  marked.push_back('\3' + made::StlTextFrom(box));
  return marked;
}
