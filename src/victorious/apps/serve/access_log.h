// The log of who read what by a server: a file of JSON lines, each with the SHA-256 of itself and of all before it.
// An entry that was changed, removed, added or moved breaks the chain from there on. That entries are missing at the
// end shows only to who has kept a later hash elsewhere. docs/formats/access_log.md describes the lines.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "victorious/base/error.h"
#include "victorious/base/file_descriptor.h"

namespace victorious {

/// A request that was answered.
struct AccessEntry {
  std::int64_t time_utc_us = 0;
  std::string actor;   ///< the account; empty: nobody in particular
  std::string client;  ///< its IP address
  std::string target;  ///< path and query
  int status = 0;
};

/// What a whole log says.
struct AccessLogSummary {
  std::int64_t entries = 0;
  std::string last_hash;             ///< of the last entry, or of the head
  std::uint64_t complete_bytes = 0;  ///< up to the last whole line
  bool is_cut_off = false;           ///< a part of a line follows, as of a server that was killed while it wrote
};

/// Whether a file begins as an access log.
[[nodiscard]] bool IsAccessLog(std::string_view first_bytes);

/// Verifies the chain. Errors: those of reading; kDataLoss, with the number of the first line that does not belong
/// there.
[[nodiscard]] Expected<AccessLogSummary> VerifyAccessLog(const std::filesystem::path& path);

/// Thread-safe.
class AccessLog {
 public:
  /// Verifies the file and goes on at its end; makes it, for its user only, if it is not there. A part of a line at the
  /// end is removed. Errors: those of VerifyAccessLog and of opening; kConflict if another server writes it.
  [[nodiscard]] static Expected<std::unique_ptr<AccessLog>> Open(const std::filesystem::path& path);

  /// The entry is with the system when this returns. Errors: kNoSpace and others of writing; then all later ones fail,
  /// too.
  [[nodiscard]] Status Append(const AccessEntry& entry);

 private:
  AccessLog(std::string name, FileDescriptor file, std::string last_hash)
      : name_(std::move(name)), file_(std::move(file)), last_hash_(std::move(last_hash)) {}

  [[nodiscard]] Status Write(std::string_view line);

  std::string name_;
  std::mutex mutex_;
  FileDescriptor file_;
  std::string last_hash_;
  std::optional<Error> failure_;
};

}  // namespace victorious
