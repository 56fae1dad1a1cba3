#include "victorious/base/file_roots.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "victorious/base/absolute_path.h"
#include "victorious/base/one_line.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// The path from "/" without links; of what is not there, the part that is.
fs::path Resolve(const fs::path& path) {
  if (char* const real = ::realpath(path.c_str(), nullptr); real != nullptr) {
    fs::path resolved = real;
    std::free(real);  // NOLINT: of realpath
    return resolved;
  }
  std::error_code error;
  const fs::path absolute = AbsolutePath(path);
  fs::path resolved = fs::weakly_canonical(absolute, error);
  return error ? absolute : resolved;
}

bool IsBelow(const fs::path& path, const fs::path& root) {
  const auto [root_end, rest] = std::ranges::mismatch(root, path);
  if (root_end != root.end()) return false;
  return std::none_of(rest, path.end(), [](const fs::path& name) { return name.native().starts_with('.'); });
}

std::unexpected<Error> OutsideError(const fs::path& path) {
  return Fail(ErrorCode::kPermissionDenied,
              fmt::format("{}: lies in none of the folders that this server opens files in: start `victorious serve` "
                          "with --videos and the folder that it lies in",
                          OneLine(path.filename().string())));
}

// What an open descriptor leads to; empty if the system does not tell.
fs::path PathOf(int descriptor) {
  std::error_code error;
  return fs::read_symlink(fmt::format("/proc/self/fd/{}", descriptor), error);
}

}  // namespace

FileRoots::FileRoots(const std::vector<fs::path>& roots, const std::vector<fs::path>& secrets) : is_limited_(true) {
  const auto resolve_all = [](const std::vector<fs::path>& paths) {
    std::vector<fs::path> resolved;
    for (const fs::path& path : paths) {
      if (!path.empty()) resolved.push_back(Resolve(path));
    }
    std::ranges::sort(resolved);
    const auto repeated = std::ranges::unique(resolved);
    resolved.erase(repeated.begin(), repeated.end());
    return resolved;
  };
  roots_ = resolve_all(roots);
  secrets_ = resolve_all(secrets);
}

bool FileRoots::HasResolved(const fs::path& path) const {
  return std::ranges::none_of(secrets_, [&](const fs::path& secret) { return secret == path; }) &&
         std::ranges::any_of(roots_, [&](const fs::path& root) { return IsBelow(path, root); });
}

bool FileRoots::Has(const fs::path& path) const {
  if (!is_limited_) return true;
  // What opens a video would take it for an address.
  return !path.native().contains("://") && HasResolved(Resolve(path));
}

Status FileRoots::Check(const fs::path& path) const {
  if (Has(path)) return {};
  return OutsideError(path);
}

Expected<OpenedFile> FileRoots::Open(const fs::path& path) const {
  VICTORIOUS_RETURN_IF_ERROR(Check(path));
  // Without waiting for the other end of a pipe.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
  if (descriptor < 0) return std::unexpected(ErrorFromErrno(errno, path.filename().string()));
  OpenedFile file{.descriptor = std::shared_ptr<const int>(new int(descriptor),
                                                           [](const int* opened) {
                                                             ::close(*opened);
                                                             delete opened;
                                                           }),
                  .path = fmt::format("/proc/self/fd/{}", descriptor)};
  // The name may have become a link to another file since it was checked.
  if (is_limited_ && !HasResolved(PathOf(descriptor))) return OutsideError(path);
  struct stat status{};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not a file", OneLine(path.filename().string())));
  }
  return file;
}

}  // namespace victorious
