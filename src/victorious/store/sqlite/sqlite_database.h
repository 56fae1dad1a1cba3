// sql::Database in a SQLite file.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/store/sql/database.h"

namespace victorious::sqlite {

/// Errors: those of OpenSqliteStore.
[[nodiscard]] Expected<std::unique_ptr<sql::Database>> OpenSqlDatabase(const std::filesystem::path& path,
                                                                       StoreMode mode);

}  // namespace victorious::sqlite
