#include "victorious/store/sqlite/open_database.h"

#include <cerrno>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "victorious/store/sqlite/migrations.h"

namespace victorious::sqlite {
namespace {

namespace fs = std::filesystem;
using ConnectionPtr = std::unique_ptr<Connection>;

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

bool IsWritable(const fs::path& path) { return ::access(path.c_str(), W_OK) == 0; }

// The write-ahead log lets others read while one writes, and loses nothing that was committed when the program is
// killed. Where the file system cannot have one, SQLite keeps its rollback journal, which needs more syncing.
Status ChooseJournal(Connection& connection) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string mode, connection.QueryText("PRAGMA journal_mode = WAL"));
  return connection.Execute(mode == "wal" ? "PRAGMA synchronous = NORMAL" : "PRAGMA synchronous = FULL");
}

Expected<ConnectionPtr> OpenForWriting(const fs::path& path) {
  if (std::error_code error; !fs::is_directory(FolderOf(path), error)) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: there is no folder {}: make it first", path.string(), FolderOf(path).string()));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(ConnectionPtr connection, Connection::Open(path, Access::kCreate));
  if (connection->IsReadOnly()) {
    return Fail(ErrorCode::kPermissionDenied,
                fmt::format("{}: cannot be written: allow writing to the file and its folder", path.string()));
  }
  const std::span<const Migration> migrations = Migrations();
  VICTORIOUS_RETURN_IF_ERROR(ReadVersion(*connection, migrations.back().version));
  VICTORIOUS_RETURN_IF_ERROR(ChooseJournal(*connection));
  VICTORIOUS_RETURN_IF_ERROR(Migrate(*connection, migrations));
  return connection;
}

// Reading through a write-ahead log needs the log's files beside the database, and tidying them away afterwards needs
// the right to write: so where writing is allowed it is asked for, and only queries are let through. Where it is not,
// the log is read as it stands; where there is none, no other process of this user can be writing.
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
  if (::stat(path.c_str(), &info) != 0) return std::unexpected(ErrorFromErrno(errno, path.string()));
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
                            "index` on it once, which brings it up to date",
                            path.string(), version, newest));
  }
  return connection;
}

}  // namespace

Expected<ConnectionPtr> OpenDatabase(const fs::path& path, StoreMode mode) {
  return mode == StoreMode::kCreate ? OpenForWriting(path) : OpenForReading(path);
}

}  // namespace victorious::sqlite
