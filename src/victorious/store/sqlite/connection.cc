#include "victorious/store/sqlite/connection.h"

#include <cerrno>

#include <fmt/format.h>
#include <sqlite3.h>

#include "victorious/store/sqlite/page_checksums.h"
#include "victorious/store/sqlite/place_functions.h"

namespace victorious::sqlite {
namespace {

int OpenFlags(Access access) {
  // Only one thread at a time uses a connection, so SQLite's mutex is not needed.
  constexpr int kCommon = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  switch (access) {
    case Access::kCreate:
      return kCommon | SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    case Access::kWrite:
      return kCommon | SQLITE_OPEN_READWRITE;
    case Access::kRead:
      return kCommon | SQLITE_OPEN_READONLY;
    case Access::kImmutable:
      break;
  }
  return kCommon | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
}

// "file:/a%20b.db?immutable=1": every byte with a meaning in a URI is encoded as %XX.
std::string ImmutableUri(std::string_view path) {
  std::string uri = "file:";
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                       c == '.' || c == '-' || c == '_';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri + "?immutable=1";
}

// The errno behind an I/O error, if SQLite still knows it: the connection's last error, or that of the database file or
// of its journal.
int SystemError(sqlite3* handle) {
  int error = sqlite3_system_errno(handle);
  for (const int which : {SQLITE_FCNTL_FILE_POINTER, SQLITE_FCNTL_JOURNAL_POINTER}) {
    if (error != 0) break;
    sqlite3_file* file = nullptr;
    sqlite3_file_control(handle, "main", which, static_cast<void*>(&file));
    if (file != nullptr && file->pMethods != nullptr) {
      file->pMethods->xFileControl(file, SQLITE_FCNTL_LAST_ERRNO, &error);
    }
  }
  return error;
}

// An untrusted database may contain a hostile schema: no function or view of it is trusted or run.
constexpr const char* kSettings =
    "PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY;";

}  // namespace

Expected<std::unique_ptr<Connection>> Connection::Open(const std::filesystem::path& path, Access access) {
  std::error_code error;
  // An absolute path, so that SQLite's special names (":memory:", "") are file names.
  const std::string absolute = std::filesystem::absolute(path, error).string();
  if (error || path.empty()) return Fail(ErrorCode::kInvalidArgument, "an index needs the name of a file");
  const std::string target = access == Access::kImmutable ? ImmutableUri(absolute) : absolute;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(target.c_str(), &handle, OpenFlags(access), ChecksumLayer());
  std::unique_ptr<Connection> connection(new Connection(path.string(), handle));
  if (code != SQLITE_OK) return std::unexpected(connection->ErrorFromCode(code));
  sqlite3_busy_timeout(handle, static_cast<int>(std::chrono::milliseconds(kBusyTimeout).count()));
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  if (access == Access::kCreate) ReserveChecksums(handle);
  if (!AddPlaceFunctions(handle)) return std::unexpected(connection->ErrorFromCode(SQLITE_NOMEM));
  VICTORIOUS_RETURN_IF_ERROR(connection->Execute(kSettings));
  return connection;
}

Connection::~Connection() {
  for (const auto& [sql, statement] : statement_cache_) sqlite3_finalize(statement);
  sqlite3_close(handle_);
}

Expected<Statement> Connection::Prepare(std::string_view sql) {
  std::string text(sql);
  if (auto node = statement_cache_.extract(text)) return Statement(*this, std::move(text), node.mapped());
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(handle_, text.c_str(), static_cast<int>(text.size()) + 1,
                                      SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if ((code & 0xff) == SQLITE_ERROR) {
    // The program's SQL is valid for the schema of this version, so the schema of the file is wrong.
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the schema does not match the version ({}): restore it from a copy, or index again",
                            name_, sqlite3_errmsg(handle_)));
  }
  if (code != SQLITE_OK) return std::unexpected(ErrorFromCode(code));
  return Statement(*this, std::move(text), statement);
}

void Connection::ReturnToCache(const std::string& sql, sqlite3_stmt* statement) {
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  if (!statement_cache_.try_emplace(sql, statement).second) sqlite3_finalize(statement);
}

Status Connection::Execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return std::unexpected(ErrorFromCode(code));
  return {};
}

Expected<std::string> Connection::QueryText(std::string_view sql) {
  VICTORIOUS_ASSIGN_OR_RETURN(Statement statement, Prepare(sql));
  VICTORIOUS_RETURN_IF_ERROR(statement.Step());
  return statement.Text(0);
}

std::int64_t Connection::Changes() const { return sqlite3_changes64(handle_); }

bool Connection::IsInTransaction() const { return sqlite3_get_autocommit(handle_) == 0; }

bool Connection::IsBusy() const { return (sqlite3_errcode(handle_) & 0xff) == SQLITE_BUSY; }

Error Connection::ErrorFromCode(int code) const {
  const std::string reason = handle_ == nullptr ? sqlite3_errstr(code) : sqlite3_errmsg(handle_);
  switch (code & 0xff) {
    case SQLITE_NOTADB:
      return {ErrorCode::kDataLoss, fmt::format("{}: not an index (not a SQLite database, or its first bytes are "
                                                "damaged): give a file that `victorious index` made",
                                                name_)};
    case SQLITE_CORRUPT:
      return DamagedIndex(name_, reason);
    case SQLITE_FULL:
      return {ErrorCode::kNoSpace, fmt::format("{}: no space left on the disk: free some, then run it again", name_)};
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {ErrorCode::kPermissionDenied,
              fmt::format("{}: cannot be written ({}): allow writing to the file and its folder", name_, reason)};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorCode::kUnavailable, fmt::format("{}: locked by another process for more than {} s: try "
                                                   "again when it has finished",
                                                   name_, kBusyTimeout.count())};
    case SQLITE_CONSTRAINT:
      if (code == SQLITE_CONSTRAINT_FOREIGNKEY) {
        return {ErrorCode::kNotFound,
                fmt::format("{}: refers to a video or model that is not in the index (another process "
                            "may have replaced it): run it again",
                            name_)};
      }
      return {ErrorCode::kInvalidArgument, fmt::format("{}: violates a constraint of the index: {}", name_, reason)};
    case SQLITE_CANTOPEN:
    case SQLITE_IOERR: {
      if (code == SQLITE_IOERR_SHMSIZE) return ErrorFromCode(SQLITE_FULL);
      const int system_error = handle_ == nullptr ? 0 : SystemError(handle_);
      if (system_error == EFBIG || system_error == ENOSPC) return ErrorFromCode(SQLITE_FULL);
      if (system_error != 0) return ErrorFromErrno(system_error, fmt::format("{}: {}", name_, reason));
      break;
    }
    default:
      break;
  }
  return {ErrorCode::kInternal, fmt::format("{}: SQLite: {} (code {})", name_, reason, code)};
}

Expected<Transaction> Transaction::Begin(Connection& connection) {
  VICTORIOUS_RETURN_IF_ERROR(connection.Execute("BEGIN IMMEDIATE"));
  return Transaction(connection);
}

Expected<Transaction> Transaction::BeginReading(Connection& connection) {
  VICTORIOUS_RETURN_IF_ERROR(connection.Execute("BEGIN"));
  return Transaction(connection);
}

// Some errors (a full disk) roll back automatically; if this fails, the next open of the file rolls back.
Transaction::~Transaction() {
  if (connection_ == nullptr || !connection_->IsInTransaction()) return;
  [[maybe_unused]] const Status status = connection_->Execute("ROLLBACK");
}

Status Transaction::Commit() {
  VICTORIOUS_RETURN_IF_ERROR(connection_->Execute("COMMIT"));
  connection_ = nullptr;
  return {};
}

}  // namespace victorious::sqlite
