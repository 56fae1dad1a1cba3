#include "victorious/store/sqlite/migrations.h"

#include <array>
#include <string>

#include <fmt/format.h>

#include "victorious/store/schema/embedded_schema.h"
#include "victorious/store/sql/row.h"

namespace victorious::sqlite {

std::span<const Migration> Migrations() {
  static constexpr std::array kMigrations = {
      Migration{1, kSchema001},  Migration{2, kSchema002},  Migration{3, kSchema003},  Migration{4, kSchema004},
      Migration{5, kSchema005},  Migration{6, kSchema006},  Migration{7, kSchema007},  Migration{8, kSchema008},
      Migration{9, kSchema009},  Migration{10, kSchema010}, Migration{11, kSchema011}, Migration{12, kSchema012},
      Migration{13, kSchema013}, Migration{14, kSchema014}, Migration{15, kSchema015}, Migration{16, kSchema016},
      Migration{17, kSchema017}, Migration{18, kSchema018}, Migration{19, kSchema019}, Migration{20, kSchema020},
      Migration{21, kSchema021}, Migration{22, kSchema022}, Migration{23, kSchema023}};
  return kMigrations;
}

Expected<int> ReadVersion(Connection& connection, int newest) {
  // One statement, so that another process cannot migrate between the three reads.
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement select, connection.Prepare("SELECT application_id, user_version, (SELECT count(*) FROM sqlite_schema) "
                                           "FROM pragma_application_id, pragma_user_version"));
  VICTORIOUS_RETURN_IF_ERROR(select.Step());
  const std::int64_t application = select.Integer(0);
  const std::int64_t version = select.Integer(1);
  const std::int64_t tables = select.Integer(2);
  if (application == 0 && version == 0 && tables == 0) return 0;
  if (application != kApplicationId) {
    return Fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: a SQLite database of another program (application id {:#010x}, an index has {:#010x}): "
                    "give a file that `victorious index` made, or a new name",
                    connection.name(), static_cast<std::uint32_t>(application), kApplicationId));
  }
  VICTORIOUS_RETURN_IF_ERROR(sql::CheckSchemaVersion(connection.name(), version, newest));
  return static_cast<int>(version);
}

Status Migrate(Connection& connection, std::span<const Migration> migrations) {
  const int newest = migrations.back().version;
  VICTORIOUS_ASSIGN_OR_RETURN(int version, ReadVersion(connection, newest));
  if (version >= newest) return {};
  // One transaction: a process that is killed leaves the file as it was, not between two versions.
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(connection));
  // Checks again while holding the write lock: no other process can be migrating now.
  VICTORIOUS_ASSIGN_OR_RETURN(version, ReadVersion(connection, newest));
  for (const Migration& migration : migrations) {
    if (version >= migration.version) continue;
    VICTORIOUS_RETURN_IF_ERROR(connection.Execute(std::string(migration.sql)));
    VICTORIOUS_RETURN_IF_ERROR(connection.Execute(
        fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId, migration.version)));
  }
  return transaction.Commit();
}

}  // namespace victorious::sqlite
