#include "victorious/store/postgres/migrations.h"

#include <array>
#include <string>

#include <fmt/format.h>

#include "victorious/store/schema/embedded_schema.h"
#include "victorious/store/sql/row.h"

namespace victorious::postgres {
namespace {

// Adds PostGIS to the database, which only an administrator may do.
Status AddPostgis(Connection& connection) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result found,
      connection.Query("SELECT installed_version IS NOT NULL FROM pg_available_extensions WHERE name = 'postgis'"));
  if (!found.Next()) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: the server has no PostGIS: install it there "
                                                     "(Debian: postgresql-15-postgis-3), then run this again",
                                                     connection.name()));
  }
  if (found.Integer(0) != 0) return {};
  const Status added = connection.Execute("CREATE EXTENSION IF NOT EXISTS postgis SCHEMA public");
  if (added || added.error().code != ErrorCode::kPermissionDenied) return added;
  return Fail(ErrorCode::kPermissionDenied,
              fmt::format("{}: the role may not add PostGIS to the database: let an administrator run CREATE EXTENSION "
                          "postgis in it, once",
                          connection.name()));
}

}  // namespace

std::span<const Migration> Migrations() {
  static constexpr std::array kMigrations = {
      Migration{1, kSchema001},  Migration{2, kSchema002},  Migration{3, kSchema003},  Migration{4, kSchema004},
      Migration{5, kSchema005},  Migration{6, kSchema006},  Migration{7, kSchema007},  Migration{8, kSchema008},
      Migration{9, kSchema009},  Migration{10, kSchema010}, Migration{11, kSchema011}, Migration{12, kSchema012},
      Migration{13, kSchema013}, Migration{14, kSchema014}, Migration{15, kSchema015}, Migration{16, kSchema016},
      Migration{17, kSchema017}, Migration{18, kSchema018}, Migration{19, kSchema019}, Migration{20, kSchema020},
      Migration{21, kSchema021}, Migration{22, kSchema022}, Migration{23, kSchema023}, Migration{24, kSchema024}};
  return kMigrations;
}

Expected<int> ReadVersion(Connection& connection, int newest) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result found, connection.Query("SELECT to_regnamespace('victorious') IS NOT NULL, "
                                                             "to_regclass('victorious.version') IS NOT NULL"));
  if (!found.Next() || found.Integer(0) == 0) return 0;
  if (found.Integer(1) == 0) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: the database has a schema {} of another program: give another database",
                            connection.name(), kSchemaName));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Result row, connection.Query("SELECT schema FROM victorious.version"));
  const std::int64_t version = row.Next() ? row.Integer(0) : 0;
  VICTORIOUS_RETURN_IF_ERROR(sql::CheckSchemaVersion(connection.name(), version, newest));
  return static_cast<int>(version);
}

Status CheckVersion(Connection& connection) {
  const int newest = Migrations().back().version;
  VICTORIOUS_ASSIGN_OR_RETURN(const int version, ReadVersion(connection, newest));
  if (version == 0) {
    return Fail(
        ErrorCode::kNotFound,
        fmt::format("{}: no index in this database: give one that `victorious index` wrote", connection.name()));
  }
  if (version == newest) return {};
  return Fail(
      ErrorCode::kUnsupported,
      fmt::format("{}: written by an older version (schema {}; this program reads {}): run `victorious index` on "
                  "it once to migrate it",
                  connection.name(), version, newest));
}

Status Migrate(Connection& connection, std::span<const Migration> migrations) {
  const int newest = migrations.back().version;
  for (const Migration& migration : migrations) {
    VICTORIOUS_ASSIGN_OR_RETURN(int version, ReadVersion(connection, newest));
    if (version >= migration.version) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(connection, Exclusion::kAll));
    // Checks again while holding the lock: no other process can be migrating now.
    VICTORIOUS_ASSIGN_OR_RETURN(version, ReadVersion(connection, newest));
    if (version >= migration.version) continue;
    if (version == 0) {
      VICTORIOUS_RETURN_IF_ERROR(AddPostgis(connection));
      VICTORIOUS_RETURN_IF_ERROR(connection.Execute(fmt::format("CREATE SCHEMA {}", kSchemaName)));
    }
    VICTORIOUS_RETURN_IF_ERROR(connection.Execute(std::string(migration.sql)));
    VICTORIOUS_RETURN_IF_ERROR(connection.Execute(
        fmt::format("DELETE FROM version; INSERT INTO version (schema) VALUES ({})", migration.version)));
    VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  }
  return {};
}

Expected<std::unique_ptr<Connection>> OpenIndex(const std::string& url, StoreMode mode,
                                                std::optional<TaskAttempt> task) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, Connection::Open(url, mode == StoreMode::kRead, {}, task));
  VICTORIOUS_RETURN_IF_ERROR(mode == StoreMode::kCreate ? Migrate(*connection, Migrations())
                                                        : CheckVersion(*connection));
  return connection;
}

}  // namespace victorious::postgres
