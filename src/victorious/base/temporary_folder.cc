#include "victorious/base/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace victorious {

Expected<std::shared_ptr<const TemporaryFolder>> TemporaryFolder::Make() {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  std::string name = (parent / "victorious-XXXXXX").string();
  if (error || ::mkdtemp(name.data()) == nullptr) {
    return std::unexpected(ErrorFromErrno(error ? error.value() : errno,
                                          "make a temporary folder in " + parent.string() + " (TMPDIR names it)"));
  }
  return std::shared_ptr<const TemporaryFolder>(new TemporaryFolder(std::move(name)));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

}  // namespace victorious
