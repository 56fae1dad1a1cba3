#include "victorious/base/folder.h"

#include <algorithm>
#include <system_error>

namespace victorious {

namespace fs = std::filesystem;

Expected<std::vector<fs::path>> ListFolder(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    paths.push_back(entry->path());
  }
  if (error) return std::unexpected(ErrorFromErrno(error.value(), folder.string()));
  std::ranges::sort(paths);
  return paths;
}

}  // namespace victorious
