#include "victorious/apps/cli/sample_files.h"

#include <filesystem>
#include <system_error>

#include "victorious/base/own_file.h"

namespace victorious::cli {

std::optional<SampleFiles> FindSample() {
  std::error_code error;
  for (const char* relative : {"..", "../share/victorious"}) {
    const std::filesystem::path folder = (OwnFile().parent_path() / relative).lexically_normal();
    SampleFiles files{.scene = folder / "scenes/demo.json", .object = folder / "assets/models/jeep.glb"};
    if (std::filesystem::exists(files.scene, error) && std::filesystem::exists(files.object, error) &&
        std::filesystem::exists(folder / "assets/town", error)) {
      return files;
    }
  }
  return std::nullopt;
}

}  // namespace victorious::cli
