// A lock on a file, for several processes that share a folder.
#pragma once

#include <filesystem>
#include <optional>

#include "victorious/base/error.h"

namespace victorious {

/// Held by one object at a time, of all processes (flock). Ends with the object, or with its process, however that
/// ends.
class FileLock {
 public:
  /// Creates the file if it does not exist. std::nullopt: another one has the lock. Errors: those of opening.
  [[nodiscard]] static Expected<std::optional<FileLock>> Try(const std::filesystem::path& path);

  /// The same, but waits for the others. Also removal of the file while waiting gives a lock that others respect.
  [[nodiscard]] static Expected<FileLock> Wait(const std::filesystem::path& path);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

  /// Of the file, open to read and write.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  [[nodiscard]] static Expected<std::optional<FileLock>> Take(const std::filesystem::path& path, int operation);

  int descriptor_;
};

}  // namespace victorious
