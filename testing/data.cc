#include "testing/data.h"

#include <cstdlib>

#include <unistd.h>

#include "victorious/base/check.h"

#ifndef VICTORIOUS_SOURCE_DIR
#error "VICTORIOUS_SOURCE_DIR must be defined by the build"
#endif

namespace victorious::testing {

namespace fs = std::filesystem;

fs::path DataPath(std::string_view relative) {
  const char* root = std::getenv("VICTORIOUS_DATA");
  return (root != nullptr ? fs::path(root) : fs::path(VICTORIOUS_SOURCE_DIR) / "../shared/data") / relative;
}

ScratchFolder::ScratchFolder() {
  std::string name = (fs::temp_directory_path() / "victorious-test-XXXXXX").string();
  VICTORIOUS_CHECK(::mkdtemp(name.data()) != nullptr);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace victorious::testing
