// The files of recorders in the database of the index, from which workers search what nobody searched as it came.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/postgres/connection.h"

namespace victorious::postgres {

/// A complete file of a live source. Times are those at which its first and its last frame came, microseconds since
/// 1970, UTC.
struct Recording {
  std::string path;    ///< absolute, the same on all machines
  std::string source;  ///< address of the live source
  std::int64_t from_utc_us = 0;
  std::int64_t to_utc_us = 0;

  bool operator==(const Recording&) const = default;
};

/// Use from one thread at a time.
class RecordingStore {
 public:
  /// @param url  of an index that exists (OpenPostgresStore)
  [[nodiscard]] static Expected<std::unique_ptr<RecordingStore>> Open(const std::string& url);

  /// @param connection  of an index of this version
  explicit RecordingStore(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}

  /// Without effect if the path is known.
  [[nodiscard]] Status Put(const Recording& recording);
  /// The file is not there any more.
  [[nodiscard]] Status Remove(const std::string& path);
  /// Nothing of it is left to be queued.
  [[nodiscard]] Status Settle(const std::string& path);

  /// By time.
  [[nodiscard]] Expected<std::vector<Recording>> Of(const std::string& source);
  /// Those that are not settled, by source and time.
  [[nodiscard]] Expected<std::vector<Recording>> Unsettled();

 private:
  std::shared_ptr<Connection> connection_;
};

}  // namespace victorious::postgres
