#include "victorious/store/sqlite/backup.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include "victorious/base/file_descriptor.h"
#include "victorious/store/sqlite/connection.h"
#include "victorious/store/sqlite/open_database.h"
#include "victorious/store/sqlite/page_checksums.h"

namespace victorious::sqlite {
namespace {

namespace fs = std::filesystem;

Status CopyPages(Connection& from, Connection& to) {
  sqlite3_backup* backup = sqlite3_backup_init(to.handle(), "main", from.handle(), "main");
  if (backup == nullptr) return std::unexpected(to.ErrorFromCode(sqlite3_errcode(to.handle())));
  constexpr int kAllPages = -1;  // in one step, which is one read transaction
  const int copied = sqlite3_backup_step(backup, kAllPages);
  const int finished = sqlite3_backup_finish(backup);
  if (copied == SQLITE_DONE && finished == SQLITE_OK) return {};
  return std::unexpected(to.ErrorFromCode(finished));
}

Status WriteCopy(Connection& from, const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto copy, Connection::Open(path, Access::kWrite));
  ReserveChecksumsAs(from.handle(), copy->handle());
  VICTORIOUS_RETURN_IF_ERROR(CopyPages(from, *copy));
  // One file, without a log beside it.
  VICTORIOUS_RETURN_IF_ERROR(copy->QueryText("PRAGMA journal_mode = DELETE"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string checked, copy->QueryText("PRAGMA integrity_check(1)"));
  if (checked == "ok") return {};
  return std::unexpected(DamagedIndex(from.name(), checked));
}

}  // namespace

Status BackUp(const fs::path& index, const fs::path& target) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto from, OpenDatabase(index, StoreMode::kRead));
  std::error_code error;
  if (fs::exists(target, error)) {
    return Fail(ErrorCode::kAlreadyExists,
                fmt::format("{}: exists already: give the name of a new file", target.string()));
  }
  const fs::path part = target.string() + ".part";
  constexpr mode_t kOnlyOwner = 0600;
  // What a backup that was killed has left is not continued.
  fs::remove(part, error);
  const int descriptor = ::open(part.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kOnlyOwner);
  if (descriptor < 0) return std::unexpected(ErrorFromErrno(errno, target.string()));
  const FileDescriptor file(descriptor);
  Status done = WriteCopy(*from, part);
  if (done && ::fsync(descriptor) != 0) done = std::unexpected(ErrorFromErrno(errno, target.string()));
  // Unlike a rename, a link replaces nothing that has come meanwhile.
  if (done && ::link(part.c_str(), target.c_str()) != 0) {
    done = std::unexpected(ErrorFromErrno(errno, target.string()));
  }
  fs::remove(part, error);
  return done;
}

}  // namespace victorious::sqlite
