// Opens the index that a user names: a SQLite file or a PostgreSQL database.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/work_state.h"

namespace victorious {

/// True if `name` is the URL of a database (postgresql://… or postgres://…), not a file.
[[nodiscard]] bool IsDatabaseUrl(std::string_view name);

/// Opens a SQLite file (OpenSqliteStore) or a PostgreSQL database (postgres/postgres_store.h: OpenPostgresStore).
/// @param task  of a database, for which a worker's process writes (postgres/connection.h: Connection::Open)
[[nodiscard]] Expected<std::unique_ptr<IndexStore>> OpenStore(const std::string& name, StoreMode mode,
                                                              std::optional<TaskAttempt> task = {});

/// True if there is an index under this name: the file exists, or the database has its schema. Errors: those of opening
/// a database.
[[nodiscard]] Expected<bool> HasIndex(const std::string& name);

/// Whether the role of a database's URL may write what `victorious serve` writes: reviews, jobs, accounts, thresholds
/// and the log. Of a file true: OpenStore says whether it can be written. Errors: those of opening a database.
[[nodiscard]] Expected<bool> MayServe(const std::string& name);

/// A name of an index without its password, which is apart.
struct StoreAddress {
  std::string name;
  std::string password;  ///< empty: the name has none
};

/// Takes the password out of a URL, so that a child process gets it by the environment (PGPASSWORD), not by its
/// arguments, which every user of the machine can read.
[[nodiscard]] StoreAddress TakePassword(const std::string& name);

/// Returns `name` for messages: a URL without its password and parameters.
[[nodiscard]] std::string StoreName(const std::string& name);

}  // namespace victorious
