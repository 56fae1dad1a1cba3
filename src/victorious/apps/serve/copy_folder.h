// The folder of the files that the server makes: copies of videos that browsers play, clips, tracks, refined category
// models. It is a cache: what was not used for the longest time is removed where the files take more than a limit, and
// is made again when somebody asks for it. Thread-safe; several servers may share a folder.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

class CopyFolder {
 public:
  struct Limits {
    std::uint64_t max_bytes = 20'000'000'000;
    /// A player fetches a file in ranges: between two of them it is in use, too.
    std::chrono::seconds in_use{60};
  };

  /// A file that is not removed as long as this, or a copy of `hold`, lives.
  struct Use {
    std::filesystem::path path;
    std::shared_ptr<const void> hold;
  };

  /// @param folder  created by Create
  CopyFolder(std::filesystem::path folder, Limits limits) : folder_(std::move(folder)), limits_(limits) {}

  /// Error: that of creating the folder.
  [[nodiscard]] Status Create() const;

  [[nodiscard]] std::filesystem::path PathOf(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] bool Has(const std::string& name) const;

  /// Marks a file as used now, also for other servers; std::nullopt: it is not there.
  [[nodiscard]] std::optional<Use> Take(const std::string& name);

  /// Removes the files that were not used for the longest time, until the others take no more than the limit. Files
  /// that are in use, being made (FILE.tmp-…), and the one that was used last stay, even if they take more. The
  /// telemetry of a clip goes with it.
  void Trim();

  /// Removes the complete files whose names begin with `prefix`, but for those of `kept` and those in use.
  void RemoveOthers(const std::string& prefix, const std::set<std::string>& kept);

 private:
  /// With the lock, and holds that are alive.
  [[nodiscard]] bool IsInUse(const std::string& name, std::int64_t used_ns) const;
  std::filesystem::path folder_;
  Limits limits_;
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<const void>> holds_;  ///< by name
};

}  // namespace victorious
