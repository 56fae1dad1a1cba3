#include "victorious/store/sqlite/open_database.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <sys/stat.h>

#include "victorious/base/missing_path.h"
#include "victorious/base/one_line.h"
#include "victorious/base/write_access.h"
#include "victorious/store/sqlite/migrations.h"

namespace victorious::sqlite {
namespace {

namespace fs = std::filesystem;
using ConnectionPtr = std::unique_ptr<Connection>;

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

// The write-ahead log allows readers while one process writes, and keeps all commits if the program is killed. On file
// systems that do not support it, SQLite uses its rollback journal, which needs full syncing. Only one process can
// change the journal mode, and SQLite does not wait for the lock here, so this function retries.
Status ChooseJournal(Connection& connection) {
  const auto deadline = std::chrono::steady_clock::now() + kBusyTimeout;
  Expected<std::string> mode = connection.QueryText("PRAGMA journal_mode = WAL");
  while (!mode && connection.IsBusy() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    mode = connection.QueryText("PRAGMA journal_mode = WAL");
  }
  if (!mode) return std::unexpected(std::move(mode).error());
  return connection.Execute(*mode == "wal" ? "PRAGMA synchronous = NORMAL" : "PRAGMA synchronous = FULL");
}

// What the file runs by itself, triggers and views, must be what a migration of this program made: word for word.
Status CheckPrograms(Connection& connection) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Statement select,
      connection.Prepare("SELECT type, name, sql FROM sqlite_schema WHERE type IN ('trigger', 'view') ORDER BY name"));
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
    if (!has_row) return {};
    const std::string sql = select.Text(2);
    const bool is_own = std::ranges::any_of(
        Migrations(), [&](const Migration& migration) { return migration.sql.find(sql) != std::string_view::npos; });
    if (is_own) continue;
    return Fail(
        ErrorCode::kDataLoss,
        fmt::format("{}: has a {} that no version of this program made ({}): it would run whenever the index is "
                    "used; restore the file from a copy, or index again",
                    connection.name(), select.Text(0), OneLine(select.Text(1))));
  }
}

Expected<ConnectionPtr> OpenForWriting(const fs::path& path) {
  std::error_code error;
  const fs::path folder = FolderOf(path);
  VICTORIOUS_RETURN_IF_ERROR(
      CheckIsFolder(folder, fmt::format("create it first, or give another folder for {}", path.filename().string())));
  // Checked beforehand: for a file without write permission, SQLite reports only that it cannot be opened.
  if (!IsWritable(folder) || (fs::exists(path, error) && !IsWritable(path))) {
    return Fail(ErrorCode::kPermissionDenied,
                fmt::format("{}: cannot be written: allow writing to the file and its folder", path.string()));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(ConnectionPtr connection, Connection::Open(path, Access::kCreate));
  const std::span<const Migration> migrations = Migrations();
  VICTORIOUS_RETURN_IF_ERROR(ReadVersion(*connection, migrations.back().version));
  VICTORIOUS_RETURN_IF_ERROR(CheckPrograms(*connection));
  VICTORIOUS_RETURN_IF_ERROR(ChooseJournal(*connection));
  VICTORIOUS_RETURN_IF_ERROR(Migrate(*connection, migrations));
  return connection;
}

// Reading a database with a write-ahead log needs the log files beside it, and removing them afterwards needs write
// permission. With write permission, the database is opened for writing and restricted to queries (query_only). Without
// it, an existing log is read in its current state; without a log, no other process of this user can be writing.
Expected<ConnectionPtr> ConnectForReading(const fs::path& path) {
  if (IsWritable(path) && IsWritable(FolderOf(path))) {
    VICTORIOUS_ASSIGN_OR_RETURN(ConnectionPtr connection, Connection::Open(path, Access::kWrite));
    VICTORIOUS_RETURN_IF_ERROR(connection->Execute("PRAGMA query_only = ON"));
    return connection;
  }
  std::error_code error;
  const auto log_size = fs::file_size(path.string() + "-wal", error);
  return Connection::Open(path, error || log_size == 0 ? Access::kImmutable : Access::kRead);
}

Expected<ConnectionPtr> OpenForReading(const fs::path& path) {
  struct stat info{};
  if (::stat(path.c_str(), &info) != 0) {
    const int problem = errno;
    if (problem == ENOENT) {
      return std::unexpected(NoSuchFile(path.string(), "`victorious index` makes an index"));
    }
    return std::unexpected(ErrorFromErrno(problem, path.string()));
  }
  if (!S_ISREG(info.st_mode)) return Fail(ErrorCode::kInvalidArgument, path.string() + ": not a regular file");
  VICTORIOUS_ASSIGN_OR_RETURN(ConnectionPtr connection, ConnectForReading(path));
  const int newest = Migrations().back().version;
  VICTORIOUS_ASSIGN_OR_RETURN(const int version, ReadVersion(*connection, newest));
  if (version == 0) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: empty: give a file that `victorious index` made", path.string()));
  }
  if (version < newest) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: written by an older version (schema {}; this program reads {}): run `victorious "
                            "index` on it once to migrate it",
                            path.string(), version, newest));
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckPrograms(*connection));
  return connection;
}

}  // namespace

Expected<ConnectionPtr> OpenDatabase(const fs::path& path, StoreMode mode) {
  return mode == StoreMode::kCreate ? OpenForWriting(path) : OpenForReading(path);
}

}  // namespace victorious::sqlite
