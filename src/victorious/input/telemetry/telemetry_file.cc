#include "victorious/input/telemetry/telemetry_file.h"

#include <system_error>

namespace victorious {

namespace fs = std::filesystem;

std::optional<fs::path> FindTelemetryFile(const std::string& video) {
  for (const fs::path& path : {fs::path(video).replace_extension(".SRT"), fs::path(video).replace_extension(".srt"),
                               fs::path(video + ".telemetry.csv"), fs::path(video).replace_extension(".telemetry.csv"),
                               fs::path(video).replace_extension(".ass")}) {
    std::error_code error;
    if (fs::is_regular_file(path, error)) return path;
  }
  return std::nullopt;
}

}  // namespace victorious
