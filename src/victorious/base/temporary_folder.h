// A folder for files that are needed while something is made, gone with the object.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/base/error.h"

namespace victorious {

class TemporaryFolder {
 public:
  /// In the system's folder for temporary files (TMPDIR); its user only can enter it. Errors: those of making it.
  [[nodiscard]] static Expected<std::shared_ptr<const TemporaryFolder>> Make();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};

}  // namespace victorious
