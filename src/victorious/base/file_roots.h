// The folders that files may lie in which somebody else has named: an index that others write names videos, telemetry
// and recordings by their paths. A server opens such a path only below a folder that its operator knows of, so that
// whoever writes the index cannot make it show other files of the machine.
//
// A path is compared after all its links are resolved. A file or a folder whose name begins with a dot, below the
// folder, is hidden and does not count as a part of it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

/// A file that is open for reading. Copies share it; the last one closes it.
struct OpenedFile {
  std::shared_ptr<const int> descriptor;
  /// A name of the open file itself, whatever its name leads to by then: "/proc/self/fd/7". Valid in this process as
  /// long as `descriptor` lives.
  std::filesystem::path path;
};

class FileRoots {
 public:
  /// Every file may be opened: what a command of the user reads.
  FileRoots() = default;

  /// @param roots    folders, and single files; one that is not there yet may be made later. None: no file
  /// @param secrets  files that are never opened, though they lie below a root
  explicit FileRoots(const std::vector<std::filesystem::path>& roots,
                     const std::vector<std::filesystem::path>& secrets = {});

  [[nodiscard]] bool is_limited() const { return is_limited_; }
  /// From "/", without links.
  [[nodiscard]] const std::vector<std::filesystem::path>& roots() const { return roots_; }

  /// Whether a file or folder may be opened. One that is not there may be, if it would lie below a root.
  [[nodiscard]] bool Has(const std::filesystem::path& path) const;

  /// Error: kPermissionDenied unless Has(path). The message has the file's name alone, and is the same whether or not
  /// there is such a file.
  [[nodiscard]] Status Check(const std::filesystem::path& path) const;

  /// Opens a file, and checks what was opened. Errors: those of Check; kInvalidArgument for what is no regular file;
  /// those of opening.
  [[nodiscard]] Expected<OpenedFile> Open(const std::filesystem::path& path) const;

 private:
  [[nodiscard]] bool HasResolved(const std::filesystem::path& path) const;

  bool is_limited_ = false;
  std::vector<std::filesystem::path> roots_;
  std::vector<std::filesystem::path> secrets_;
};

}  // namespace victorious
