#include "victorious/store/open_store.h"

#include "victorious/store/postgres/postgres_store.h"

namespace victorious {

bool IsDatabaseUrl(std::string_view name) {
  return name.starts_with("postgresql://") || name.starts_with("postgres://");
}

Expected<std::unique_ptr<IndexStore>> OpenStore(const std::string& name, StoreMode mode) {
  return IsDatabaseUrl(name) ? OpenPostgresStore(name, mode) : OpenSqliteStore(name, mode);
}

std::string StoreName(const std::string& name) { return IsDatabaseUrl(name) ? postgres::DatabaseName(name) : name; }

}  // namespace victorious
