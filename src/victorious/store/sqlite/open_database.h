// Opens the connection to an index after checking its application id and schema version.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

/// See OpenSqliteStore. Never modifies another program's database.
[[nodiscard]] Expected<std::unique_ptr<Connection>> OpenDatabase(const std::filesystem::path& path, StoreMode mode);

}  // namespace victorious::sqlite
