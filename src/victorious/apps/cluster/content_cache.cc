#include "victorious/apps/cluster/content_cache.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "victorious/base/absolute_path.h"
#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/missing_path.h"
#include "victorious/base/one_line.h"
#include "victorious/input/video/read_address.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kOtherWorkerPoll{200};
constexpr const char* kPartEnding = ".part";
constexpr const char* kLockEnding = ".lock";

std::string Gigabytes(std::int64_t bytes) { return fmt::format("{:.3g} GB", static_cast<double>(bytes) / 1e9); }

bool IsPresent(const ContentFile& file) {
  std::error_code absent;
  return fs::is_regular_file(file.path, absent) &&
         fs::file_size(file.path, absent) == static_cast<std::uintmax_t>(file.bytes) && !absent;
}

Status CreateFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return {};
  return std::unexpected(ErrorFromErrno(error.value(), fmt::format("create {}", OneLine(folder.string()))));
}

std::unexpected<Error> FailedToLink(const std::error_code& error, const fs::path& target) {
  return std::unexpected(ErrorFromErrno(error.value(), fmt::format("link {}", OneLine(target.string()))));
}

// Removes what killed workers left: folders of tasks whose lock nobody holds.
void RemoveLeftovers(const fs::path& tasks) {
  std::error_code ignored;
  for (const fs::path& path : ListFolder(tasks).value_or(std::vector<fs::path>())) {
    if (path.extension() != kLockEnding) continue;
    const auto lock = FileLock::Try(path);
    if (!lock || !*lock) continue;
    fs::remove_all(fs::path(path).replace_extension(), ignored);
    fs::remove(path, ignored);
  }
}

struct CachedFile {
  fs::path path;
  std::int64_t bytes = 0;
  std::int64_t used_ns = 0;
  bool is_in_use = false;
};

// Of a file that is being fetched, the bytes are those that it will have.
std::vector<CachedFile> ListCached(const fs::path& folder) {
  std::vector<CachedFile> files;
  for (const fs::path& path : ListFolder(folder).value_or(std::vector<fs::path>())) {
    struct stat info{};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) continue;
    const bool is_part = path.extension() == kPartEnding;
    bool is_in_use = info.st_nlink > 1;  // a task reads it
    if (is_part) {
      const auto lock = FileLock::Try(path);
      is_in_use = !lock || !*lock;
    }
    files.push_back({.path = path,
                     .bytes = info.st_size,
                     .used_ns = std::int64_t{info.st_mtim.tv_sec} * 1'000'000'000 + info.st_mtim.tv_nsec,
                     .is_in_use = is_in_use});
  }
  return files;
}

Status WriteTo(int descriptor, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("write {}", OneLine(path.string()))));
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

bool HasUserInfo(const std::string& address) {
  const std::size_t begin = address.find("://") + 3;
  return address.substr(begin, address.find('/', begin) - begin).contains('@');
}

}  // namespace

TaskFiles::~TaskFiles() {
  if (!lock_) return;
  std::error_code ignored;
  fs::remove_all(root_, ignored);
  fs::remove(root_.string() + kLockEnding, ignored);
}

Expected<ContentCache> ContentCache::Open(ContentCacheOptions options) {
  if (IsWebAddress(options.place)) {
    if (HasUserInfo(options.place)) {
      return Fail(ErrorCode::kInvalidArgument,
                  "the address of the content has a name or a password in it, which messages would show: give one "
                  "without");
    }
  } else {
    VICTORIOUS_RETURN_IF_ERROR(CheckIsFolder(options.place,
                                             "give the one that `victorious submit --publish` writes, or its address, "
                                             "http://… or https://…"));
  }
  for (const char* name : {"files", "tasks"}) VICTORIOUS_RETURN_IF_ERROR(CreateFolder(options.folder / name));
  options.folder = AbsolutePath(options.folder);
  return ContentCache(std::move(options));
}

Expected<TaskFiles> ContentCache::Provide(std::span<const ContentFile> files,
                                          const std::function<bool()>& is_stopped) const {
  std::int64_t missing_bytes = 0;
  bool is_any_missing = false;
  for (const ContentFile& file : files) {
    if (IsPresent(file)) continue;
    is_any_missing = true;
    missing_bytes += file.bytes;
  }
  if (!is_any_missing) return TaskFiles();
  if (missing_bytes > options_.max_bytes) {
    return Fail(
        ErrorCode::kNoSpace,
        fmt::format("{}: the files of this task take {}, above the limit of {}: raise --cache-size",
                    OneLine(options_.folder.string()), Gigabytes(missing_bytes), Gigabytes(options_.max_bytes)));
  }
  RemoveLeftovers(options_.folder / "tasks");
  VICTORIOUS_ASSIGN_OR_RETURN(TaskFiles provided, MakeTaskFolder());
  for (const ContentFile& file : files) {
    const fs::path target = provided.root() + file.path;
    VICTORIOUS_RETURN_IF_ERROR(CreateFolder(target.parent_path()));
    if (IsPresent(file)) {
      std::error_code error;
      fs::create_symlink(file.path, target, error);
      if (error) return FailedToLink(error, target);
    } else if (Status status = Fetch(file, target, is_stopped); !status) {
      return std::unexpected(std::move(status).error().WithContext(OneLine(file.path)));
    }
  }
  return provided;
}

Expected<TaskFiles> ContentCache::MakeTaskFolder() const {
  for (int number = 0;; ++number) {
    const fs::path root = options_.folder / "tasks" / fmt::format("{}-{}", ::getpid(), number);
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<FileLock> lock, FileLock::Try(root.string() + kLockEnding));
    if (!lock) continue;  // of another machine with the same folder
    TaskFiles made(root, *std::move(lock));
    std::error_code error;
    fs::remove_all(root, error);
    VICTORIOUS_RETURN_IF_ERROR(CreateFolder(root));
    return made;
  }
}

Status ContentCache::Fetch(const ContentFile& file, const fs::path& target,
                           const std::function<bool()>& is_stopped) const {
  const fs::path lock_path = options_.folder / "lock";
  while (true) {
    std::optional<FileLock> part;
    {
      VICTORIOUS_ASSIGN_OR_RETURN(const FileLock lock, FileLock::Wait(lock_path));
      VICTORIOUS_ASSIGN_OR_RETURN(const bool is_linked, LinkCached(file, target));
      if (is_linked) return {};
      VICTORIOUS_RETURN_IF_ERROR(MakeRoom(file));
      VICTORIOUS_ASSIGN_OR_RETURN(part, FileLock::Try(PartPath(file)));
      // Others count the bytes that it will have.
      if (part && ::ftruncate(part->descriptor(), file.bytes) != 0) {
        return std::unexpected(ErrorFromErrno(errno, fmt::format("write {}", PartPath(file).string())));
      }
    }
    if (part) {
      Status status = Download(file, *part, is_stopped);
      VICTORIOUS_ASSIGN_OR_RETURN(const FileLock lock, FileLock::Wait(lock_path));
      std::error_code error;
      if (status) {
        fs::rename(PartPath(file), CachedPath(file), error);
        if (!error) fs::create_hard_link(CachedPath(file), target, error);
        if (error) return FailedToLink(error, target);
      } else {
        fs::remove(PartPath(file), error);
      }
      return status;
    }
    // Another worker fetches it.
    if (is_stopped()) return Fail(ErrorCode::kCancelled, "stopped while another worker fetches it");
    std::this_thread::sleep_for(kOtherWorkerPoll);
  }
}

Expected<bool> ContentCache::LinkCached(const ContentFile& file, const fs::path& target) const {
  const fs::path cached = CachedPath(file);
  std::error_code error;
  if (fs::file_size(cached, error) != static_cast<std::uintmax_t>(file.bytes) || error) {
    fs::remove(cached, error);
    return false;
  }
  fs::create_hard_link(cached, target, error);
  if (error) return FailedToLink(error, target);
  if (::utimensat(AT_FDCWD, cached.c_str(), nullptr, 0) != 0) {
    return std::unexpected(ErrorFromErrno(errno, OneLine(cached.string())));
  }
  return true;
}

Status ContentCache::MakeRoom(const ContentFile& file) const {
  std::vector<CachedFile> files = ListCached(options_.folder / "files");
  // What another worker fetches has its room already.
  std::erase_if(files, [&](const CachedFile& one) { return one.path == PartPath(file); });
  std::ranges::sort(files, {}, &CachedFile::used_ns);
  std::int64_t total = file.bytes;
  std::int64_t in_use = 0;
  for (const CachedFile& one : files) {
    total += one.bytes;
    in_use += one.is_in_use ? one.bytes : 0;
  }
  for (const CachedFile& one : files) {
    if (total <= options_.max_bytes) return {};
    if (one.is_in_use) continue;
    std::error_code error;
    if (fs::remove(one.path, error)) total -= one.bytes;
  }
  if (total <= options_.max_bytes) return {};
  return Fail(ErrorCode::kUnavailable,
              fmt::format("{}: no room for {}: tasks use {} of {}: raise --cache-size, or wait for them",
                          OneLine(options_.folder.string()), Gigabytes(file.bytes), Gigabytes(in_use),
                          Gigabytes(options_.max_bytes)));
}

Status ContentCache::Download(const ContentFile& file, const FileLock& part,
                              const std::function<bool()>& is_stopped) const {
  const std::string source = SourceOf(file);
  const fs::path path = PartPath(file);
  std::int64_t done = 0;
  const auto is_wrong = [&](const std::string& what) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: {}: publish the file again (`victorious submit --publish`)", OneLine(source), what));
  };
  const auto write = [&](std::span<const std::byte> bytes) -> Status {
    done += std::ssize(bytes);
    if (done > file.bytes) return is_wrong(fmt::format("more than the {} bytes that were submitted", file.bytes));
    return WriteTo(part.descriptor(), bytes, path);
  };
  VICTORIOUS_RETURN_IF_ERROR(ReadAddress(source, {.timeout_s = options_.timeout_s, .is_stopped = is_stopped}, write));
  if (done < file.bytes) return is_wrong(fmt::format("{} of the {} bytes that were submitted", done, file.bytes));
  if (::fsync(part.descriptor()) != 0) {
    return std::unexpected(ErrorFromErrno(errno, fmt::format("write {}", OneLine(path.string()))));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content_id, ContentId(path));
  if (content_id != file.content_id) return is_wrong("not the content that was submitted, its hash is " + content_id);
  return {};
}

std::string ContentCache::SourceOf(const ContentFile& file) const {
  return fmt::format("{}{}{}", options_.place, options_.place.ends_with('/') ? "" : "/", PathInPlace(file).string());
}

fs::path ContentCache::CachedPath(const ContentFile& file) const { return options_.folder / "files" / file.content_id; }

fs::path ContentCache::PartPath(const ContentFile& file) const { return CachedPath(file).string() + kPartEnding; }

}  // namespace victorious
