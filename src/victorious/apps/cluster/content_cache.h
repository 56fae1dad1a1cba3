// The files of tasks that are not on this machine: fetched from a place (content_file.h), verified by their hash, and
// kept in a folder of limited size for the next task. Several workers may share the folder.
//
//   DIR/files/HASH       complete files; those that were not used for the longest time are removed first
//   DIR/files/HASH.part  being fetched, under a lock
//   DIR/tasks/N/PATH     what one task reads, at the paths of who submitted it: links to DIR/files and to local files
//   DIR/lock             held by who looks at or changes what is in DIR/files
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "victorious/apps/cluster/content_file.h"
#include "victorious/base/error.h"
#include "victorious/base/file_lock.h"

namespace victorious {

struct ContentCacheOptions {
  std::string place;             ///< a folder, or the address of one: "https://host/content"
  std::filesystem::path folder;  ///< created if it does not exist
  std::int64_t max_bytes = 0;    ///< of all files in it
  double timeout_s = 30;         ///< for a server that sends nothing
};

/// The files of a task as long as this lives.
class TaskFiles {
 public:
  TaskFiles() = default;
  TaskFiles(std::filesystem::path root, FileLock lock) : root_(std::move(root)), lock_(std::move(lock)) {}
  TaskFiles(TaskFiles&& other) noexcept = default;
  TaskFiles& operator=(TaskFiles&& other) = delete;
  ~TaskFiles();

  /// The file PATH of the task lies at root() + PATH; empty: all lie at their paths.
  [[nodiscard]] std::string root() const { return root_.string(); }

 private:
  std::filesystem::path root_;
  std::optional<FileLock> lock_;  ///< of `root_`, beside it
};

/// Use from one thread at a time.
class ContentCache {
 public:
  /// Errors: kInvalidArgument for an address with a password, which messages would show; kNotFound for a folder that
  /// does not exist; those of creating the cache.
  [[nodiscard]] static Expected<ContentCache> Open(ContentCacheOptions options);

  /// Fetches the files that are not at their paths with their size.
  /// @param is_stopped  asked several times a second; ends this with kCancelled
  /// Errors: kDataLoss for a file that was cut off or has another content; kNotFound for one that the place does not
  /// have; kNoSpace if they need more than the limit, or the disk is full; kUnavailable if the place does not answer,
  /// or other workers use too much of the cache: later it may be possible.
  [[nodiscard]] Expected<TaskFiles> Provide(std::span<const ContentFile> files,
                                            const std::function<bool()>& is_stopped) const;

 private:
  explicit ContentCache(ContentCacheOptions options) : options_(std::move(options)) {}

  [[nodiscard]] Expected<TaskFiles> MakeTaskFolder() const;
  /// Makes `target` a link to the file, which is fetched if it is not in the cache.
  [[nodiscard]] Status Fetch(const ContentFile& file, const std::filesystem::path& target,
                             const std::function<bool()>& is_stopped) const;
  /// With the lock of the cache. Returns false if the file is not in the cache.
  [[nodiscard]] Expected<bool> LinkCached(const ContentFile& file, const std::filesystem::path& target) const;
  /// With the lock of the cache: removes files until `bytes` more fit.
  [[nodiscard]] Status MakeRoom(const ContentFile& file) const;
  [[nodiscard]] Status Download(const ContentFile& file, const FileLock& part,
                                const std::function<bool()>& is_stopped) const;
  [[nodiscard]] std::string SourceOf(const ContentFile& file) const;
  [[nodiscard]] std::filesystem::path CachedPath(const ContentFile& file) const;
  [[nodiscard]] std::filesystem::path PartPath(const ContentFile& file) const;

  ContentCacheOptions options_;
};

}  // namespace victorious
