// What makes a database an index of this program, and of which version: SQLite's application id and user version.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

/// "VICT" in ASCII: PRAGMA application_id of every index.
inline constexpr std::int64_t kApplicationId = 0x56494354;

/// SQL that takes a database from version - 1 to `version`.
struct Migration {
  int version = 0;
  std::string_view sql;
};

/// All migrations, in order: versions 1, 2, ….
std::span<const Migration> Migrations();

/// The schema's version; 0 for a database with nothing in it. Errors: kUnsupported (another program's, or newer than
/// `newest`), kDataLoss (not a database, or damaged). Writes nothing.
Expected<int> ReadVersion(Connection& connection, int newest);

/// Brings the database to the last of `migrations`, each in a transaction of its own. Two processes may do so at once.
Status Migrate(Connection& connection, std::span<const Migration> migrations);

}  // namespace victorious::sqlite
