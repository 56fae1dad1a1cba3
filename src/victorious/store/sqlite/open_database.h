// From a path to a connection on an index that is known to be one, of a version that this program reads.
#pragma once

#include <filesystem>
#include <memory>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

/// See OpenSqliteStore. Another program's database is not touched.
Expected<std::unique_ptr<Connection>> OpenDatabase(const std::filesystem::path& path, StoreMode mode);

}  // namespace victorious::sqlite
