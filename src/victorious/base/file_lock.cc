#include "victorious/base/file_lock.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace victorious {
namespace {

// Whether the path still names the open file.
bool IsAt(const std::filesystem::path& path, int descriptor) {
  struct stat opened{};
  struct stat named{};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

}  // namespace

Expected<std::optional<FileLock>> FileLock::Try(const std::filesystem::path& path) {
  return Take(path, LOCK_EX | LOCK_NB);
}

Expected<FileLock> FileLock::Wait(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<FileLock> lock, Take(path, LOCK_EX));
  return *std::move(lock);
}

Expected<std::optional<FileLock>> FileLock::Take(const std::filesystem::path& path, int operation) {
  const auto failed = [&] { return std::unexpected(ErrorFromErrno(errno, fmt::format("lock {}", path.string()))); };
  while (true) {
    FileLock lock(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (lock.descriptor_ < 0) return failed();
    while (::flock(lock.descriptor_, operation) != 0) {
      if (errno == EWOULDBLOCK) return std::nullopt;
      if (errno != EINTR) return failed();
    }
    if (IsAt(path, lock.descriptor_)) return std::optional(std::move(lock));  // else removed by who had the lock
  }
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace victorious
