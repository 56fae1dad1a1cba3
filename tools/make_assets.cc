// make_assets DIR [NAME...]: makes the project's own models and town in DIR, all of it or what is named. The same bytes
// each time with the same OpenCV. Nothing of it comes from elsewhere: shapes and paint are in the assets_*.cc beside.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tools/assets_asset.h"
#include "tools/assets_catalogue.h"
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

Status Make(const assets::Entry& entry, const fs::path& folder) {
  const fs::path path = folder / (entry.path + ".glb");
  const assets::Asset asset = entry.make();
  const assets::Finished model = assets::Finish(asset);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, assets::GlbBytes(asset.name, model));
  VICTORIOUS_RETURN_IF_ERROR(MakeFolder(path.parent_path()));
  fmt::print("{}: {} triangles, {} KB\n", path.string(), model.indices.size() / 3, bytes.size() / 1024);
  return victorious::WriteFileAtomically(path, bytes);
}

Status MakeAll(const fs::path& folder, const std::vector<std::string>& names) {
  for (const assets::Entry& entry : assets::Catalogue()) {
    if (names.empty() || std::ranges::find(names, fs::path(entry.path).filename().string()) != names.end()) {
      VICTORIOUS_RETURN_IF_ERROR(Make(entry, folder));
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "make_assets: give the folder to write to: make_assets DIR [NAME...]\n");
    return victorious::ExitStatus(victorious::ErrorCode::kInvalidArgument);
  }
  if (const Status made = MakeAll(argv[1], {argv + 2, argv + argc}); !made) {
    fmt::print(stderr, "make_assets: {}\n", made.error().message);
    return victorious::ExitStatus(made.error().code);
  }
  return 0;
}
