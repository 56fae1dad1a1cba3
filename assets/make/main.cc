// make_assets DIR [NAME...]: writes the project's models and town assets to DIR, all of them or those named. The output
// is byte-identical for the same version of OpenCV. All shapes and textures are procedural: see assets_*.cc.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "assets/make/asset.h"
#include "assets/make/catalogue.h"
#include "assets/make/ground.h"
#include "victorious/base/error.h"
#include "victorious/base/file.h"

namespace {

namespace fs = std::filesystem;
namespace assets = victorious::assets;
using victorious::Status;

Status MakeFolder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return std::unexpected(victorious::ErrorFromErrno(failed.value(), "make folder " + folder.string()));
  return {};
}

Status WriteGlb(const assets::TexturedMesh& model, const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, assets::GlbBytes(path.stem().string(), model));
  fmt::print("{}: {} triangles, {} KB\n", path.string(), model.indices.size() / 3, bytes.size() / 1024);
  return victorious::WriteFileAtomically(path, bytes);
}

Status WriteJpeg(const cv::Mat& image, const fs::path& path) {
  constexpr int kQuality = 80;
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality})) {
    return victorious::Fail(victorious::ErrorCode::kInternal, "cannot encode " + path.string());
  }
  fmt::print("{}: {} KB\n", path.string(), bytes.size() / 1024);
  return victorious::WriteFileAtomically(path, std::as_bytes(std::span(bytes)));
}

Status MakeAll(const fs::path& folder, const std::vector<std::string>& names) {
  const auto wanted = [&](const fs::path& path) {
    return names.empty() || std::ranges::find(names, path.stem().string()) != names.end();
  };
  for (const char* below :
       {"models", "town", "town/ground", "town/tiles", "town/buildings", "town/trees", "town/cars", "town/props"}) {
    VICTORIOUS_RETURN_IF_ERROR(MakeFolder(folder / below));
  }
  for (const assets::Entry& entry : assets::Catalogue()) {
    const fs::path path = folder / (entry.path + ".glb");
    if (wanted(path)) VICTORIOUS_RETURN_IF_ERROR(WriteGlb(assets::BuildTexturedMesh(entry.make()), path));
  }
  for (const assets::MaterialEntry& entry : assets::Materials()) {
    const fs::path path = folder / "town/ground" / (entry.name + ".jpg");
    if (wanted(path)) VICTORIOUS_RETURN_IF_ERROR(WriteJpeg(entry.make().image(), path));
  }
  for (const assets::TileEntry& entry : assets::Tiles()) {
    const fs::path path = folder / "town/tiles" / (entry.name + ".glb");
    if (wanted(path)) VICTORIOUS_RETURN_IF_ERROR(WriteGlb(assets::GroundTile(entry.make()), path));
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "make_assets: no output folder: must be make_assets DIR [NAME...]\n");
    return victorious::ExitStatus(victorious::ErrorCode::kInvalidArgument);
  }
  if (const Status made = MakeAll(argv[1], {argv + 2, argv + argc}); !made) {
    fmt::print(stderr, "make_assets: {}\n", made.error().message);
    return victorious::ExitStatus(made.error().code);
  }
  return 0;
}
