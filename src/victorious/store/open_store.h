// Opens the index that a user names: a SQLite file or a PostgreSQL database.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// True if `name` is the URL of a database (postgresql://… or postgres://…), not a file.
[[nodiscard]] bool IsDatabaseUrl(std::string_view name);

/// Opens a SQLite file (OpenSqliteStore) or a PostgreSQL database (postgres/postgres_store.h: OpenPostgresStore).
[[nodiscard]] Expected<std::unique_ptr<IndexStore>> OpenStore(const std::string& name, StoreMode mode);

/// Returns `name` for messages: a URL without its password and parameters.
[[nodiscard]] std::string StoreName(const std::string& name);

}  // namespace victorious
