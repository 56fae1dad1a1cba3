#include "victorious/store/open_store.h"

#include <filesystem>
#include <system_error>

#include "victorious/store/postgres/migrations.h"
#include "victorious/store/postgres/postgres_database.h"
#include "victorious/store/postgres/postgres_store.h"
#include "victorious/store/sql/sql_threshold_store.h"
#include "victorious/store/sql/sql_triage_store.h"
#include "victorious/store/sqlite/sqlite_database.h"
#include "victorious/store/triage_store.h"

namespace victorious {
namespace {

// No request waits longer for a statement.
constexpr std::string_view kReaderSettings = "-c statement_timeout=30s";

}  // namespace

bool IsDatabaseUrl(std::string_view name) {
  return name.starts_with("postgresql://") || name.starts_with("postgres://");
}

Expected<std::unique_ptr<IndexStore>> OpenStore(const std::string& name, StoreMode mode,
                                                std::optional<TaskAttempt> task) {
  return IsDatabaseUrl(name) ? OpenPostgresStore(name, mode, task) : OpenSqliteStore(name, mode);
}

Expected<bool> HasIndex(const std::string& name) {
  if (!IsDatabaseUrl(name)) {
    std::error_code error;
    return std::filesystem::exists(name, error);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto connection, postgres::Connection::Open(name, /*is_read_only=*/true));
  VICTORIOUS_ASSIGN_OR_RETURN(const int version,
                              postgres::ReadVersion(*connection, postgres::Migrations().back().version));
  return version > 0;
}

Expected<bool> MayServe(const std::string& name) {
  if (!IsDatabaseUrl(name)) return true;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto connection, postgres::Connection::Open(name, /*is_read_only=*/true));
  VICTORIOUS_ASSIGN_OR_RETURN(
      postgres::Result row,
      connection->Query("SELECT NOT pg_is_in_recovery() AND has_any_column_privilege('objects', 'UPDATE') AND "
                        "bool_and(has_table_privilege(name, 'INSERT') AND has_table_privilege(name, 'DELETE')) "
                        "FROM (VALUES ('reviews'), ('decisions'), ('credentials'), ('thresholds')) AS written (name)",
                        postgres::BoundValues()));
  return row.Next() && row.Integer(0) != 0;
}

StoreAddress TakePassword(const std::string& name) {
  return IsDatabaseUrl(name) ? postgres::TakePassword(name) : StoreAddress{.name = name, .password = {}};
}

Expected<IndexReader> OpenIndexReader(const std::string& name) {
  IndexReader reader;
  if (!IsDatabaseUrl(name)) {
    VICTORIOUS_ASSIGN_OR_RETURN(reader.sightings, OpenSqliteStore(name, StoreMode::kRead));
    VICTORIOUS_ASSIGN_OR_RETURN(reader.objects, OpenTriageStore(name));
    VICTORIOUS_ASSIGN_OR_RETURN(reader.thresholds, OpenThresholdStore(name, StoreMode::kRead));
    return reader;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<postgres::Connection> connection,
                              postgres::Connection::Open(name, /*is_read_only=*/true, kReaderSettings));
  VICTORIOUS_RETURN_IF_ERROR(postgres::CheckVersion(*connection));
  reader.sightings = std::make_unique<postgres::PostgresStore>(connection);
  reader.objects = sql::MakeTriageStore(postgres::MakeSqlDatabase(connection));
  reader.thresholds = sql::MakeThresholdStore(postgres::MakeSqlDatabase(std::move(connection)));
  return reader;
}

std::string StoreName(const std::string& name) { return IsDatabaseUrl(name) ? postgres::DatabaseName(name) : name; }

}  // namespace victorious

namespace victorious::sql {

Expected<std::unique_ptr<Database>> OpenDatabase(const std::string& name, StoreMode mode) {
  return IsDatabaseUrl(name) ? postgres::OpenSqlDatabase(name, mode) : sqlite::OpenSqlDatabase(name, mode);
}

}  // namespace victorious::sql
