// sql::Database in a PostgreSQL database.
#pragma once

#include <memory>
#include <string>

#include "victorious/store/postgres/connection.h"
#include "victorious/store/sql/database.h"

namespace victorious::postgres {

/// @param connection  of a database with an index of this version
[[nodiscard]] std::unique_ptr<sql::Database> MakeSqlDatabase(std::shared_ptr<Connection> connection);

/// Errors: those of OpenPostgresStore.
[[nodiscard]] Expected<std::unique_ptr<sql::Database>> OpenSqlDatabase(const std::string& url, StoreMode mode);

}  // namespace victorious::postgres
