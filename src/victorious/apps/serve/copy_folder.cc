#include "victorious/apps/serve/copy_folder.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>

#include "victorious/base/folder.h"
#include "victorious/base/log.h"
#include "victorious/show/drawn_video.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

struct MadeFile {
  std::int64_t used_ns = 0;  ///< since 1970
  std::uint64_t bytes = 0;
  std::string name;
};

std::int64_t Nanoseconds(const timespec& time) { return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; }

// The complete files of the folder, the one that was used last at the end.
std::vector<MadeFile> List(const fs::path& folder) {
  std::vector<MadeFile> files;
  const auto paths = ListFolder(folder);
  // No copy was made yet, or the folder is gone: nothing to remove.
  if (!paths && paths.error().code != ErrorCode::kNotFound) LogWarning("{}", paths.error().message);
  for (const fs::path& path : paths.value_or(std::vector<fs::path>())) {
    std::string name = path.filename().string();
    struct stat status{};
    const bool is_made = name.ends_with(".mp4") || name.ends_with(".jsonl") || name.ends_with(".vcat");
    if (!is_made || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    files.push_back({.used_ns = std::max(Nanoseconds(status.st_atim), Nanoseconds(status.st_mtim)),
                     .bytes = static_cast<std::uint64_t>(status.st_size),
                     .name = std::move(name)});
  }
  std::ranges::sort(files, {}, [](const MadeFile& file) { return std::tie(file.used_ns, file.name); });
  return files;
}

std::int64_t NowNs() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return Nanoseconds(now);
}

}  // namespace

Status CopyFolder::Create() const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), "create " + folder_.string()));
  return {};
}

bool CopyFolder::Has(const std::string& name) const {
  std::error_code error;
  return fs::is_regular_file(folder_ / name, error);
}

std::optional<CopyFolder::Use> CopyFolder::Take(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  if (!Has(name)) return std::nullopt;
  std::shared_ptr<const void> hold = holds_[name].lock();
  if (!hold) {
    hold = std::make_shared<const int>();
    holds_[name] = hold;
  }
  // The time of access alone: that of change is a part of the entity tag. Where it cannot be set, the file counts as
  // not used since it was made.
  const timespec times[2] = {{.tv_sec = 0, .tv_nsec = UTIME_NOW}, {.tv_sec = 0, .tv_nsec = UTIME_OMIT}};
  [[maybe_unused]] const int result = ::utimensat(AT_FDCWD, (folder_ / name).c_str(), times, 0);
  return Use{.path = folder_ / name, .hold = std::move(hold)};
}

void CopyFolder::Trim() {
  const std::scoped_lock lock(mutex_);
  std::erase_if(holds_, [](const auto& one) { return one.second.expired(); });
  const std::vector<MadeFile> files = List(folder_);
  std::uint64_t total = 0;
  for (const MadeFile& file : files) total += file.bytes;
  for (std::size_t i = 0; i + 1 < files.size() && total > limits_.max_bytes; ++i) {
    if (IsInUse(files[i].name, files[i].used_ns)) continue;
    std::error_code error;
    if (!fs::remove(folder_ / files[i].name, error) && error) {
      LogWarning("remove {}: {}", (folder_ / files[i].name).string(), error.message());
      continue;
    }
    total -= files[i].bytes;
    fs::remove(ClipTelemetryPath(folder_ / files[i].name), error);
    if (error) LogWarning("remove the telemetry of {}: {}", (folder_ / files[i].name).string(), error.message());
  }
}

void CopyFolder::RemoveOthers(const std::string& prefix, const std::set<std::string>& kept) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(holds_, [](const auto& one) { return one.second.expired(); });
  for (const MadeFile& file : List(folder_)) {
    if (!file.name.starts_with(prefix) || kept.contains(file.name) || IsInUse(file.name, file.used_ns)) continue;
    std::error_code error;
    if (!fs::remove(folder_ / file.name, error) && error) {
      LogWarning("remove {}: {}", (folder_ / file.name).string(), error.message());
    }
  }
}

bool CopyFolder::IsInUse(const std::string& name, std::int64_t used_ns) const {
  return holds_.contains(name) || used_ns > NowNs() - std::chrono::nanoseconds(limits_.in_use).count();
}

}  // namespace victorious
