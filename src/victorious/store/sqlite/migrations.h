// Schema versions and migrations. SQLite's application id identifies an index of this program, its user version the
// schema version.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

/// "VICT" in ASCII: PRAGMA application_id of every index.
inline constexpr std::int64_t kApplicationId = 0x56494354;

/// The SQL that migrates a database from version - 1 to `version`.
struct Migration {
  int version = 0;
  std::string_view sql;
};

/// Returns all migrations in order: versions 1, 2, ….
std::span<const Migration> Migrations();

/// Returns the schema version; 0 for an empty database. Errors: kUnsupported (another program's, or newer than
/// `newest`), kDataLoss (not a database, or damaged). Does not write.
[[nodiscard]] Expected<int> ReadVersion(Connection& connection, int newest);

/// Migrates the database to the last of `migrations`, in one transaction: a process that is killed or fails leaves the
/// file as it was. Safe if two processes do so at once.
[[nodiscard]] Status Migrate(Connection& connection, std::span<const Migration> migrations);

}  // namespace victorious::sqlite
