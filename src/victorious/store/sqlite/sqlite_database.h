// sql::Database in a SQLite file.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/store/sql/database.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

/// @param connection  of an index of this version
[[nodiscard]] std::unique_ptr<sql::Database> MakeSqlDatabase(std::shared_ptr<Connection> connection);

/// Errors: those of OpenSqliteStore.
[[nodiscard]] Expected<std::unique_ptr<sql::Database>> OpenSqlDatabase(const std::filesystem::path& path,
                                                                       StoreMode mode);

}  // namespace victorious::sqlite
