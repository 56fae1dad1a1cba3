// Paths that are found from any folder.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace victorious {

/// Returns the path from the root, without "." and ".."; empty for none, and as it is where the folder of this process
/// is not known.
[[nodiscard]] inline std::string AbsolutePath(const std::filesystem::path& path) {
  if (path.empty()) return {};
  std::error_code unknown;
  const std::filesystem::path absolute = std::filesystem::absolute(path, unknown);
  return unknown ? path.string() : absolute.lexically_normal().string();
}

}  // namespace victorious
