// victorious backup --db FILE --to FILE: a copy of an index while it is used
#include <memory>
#include <string>

#include <fmt/format.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/store/open_store.h"
#include "victorious/store/sqlite/backup.h"

namespace victorious::cli {
namespace {

struct BackupArguments {
  std::string db;
  std::string to;
};

Status Run(const BackupArguments& arguments) {
  if (IsDatabaseUrl(arguments.db)) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: a database is copied by `pg_dump --format custom --schema victorious`, while it is "
                            "used, too (docs/cluster.md)",
                            StoreName(arguments.db)));
  }
  VICTORIOUS_RETURN_IF_ERROR(sqlite::BackUp(arguments.db, arguments.to));
  LogInfo("{}: a copy of {}, without damage", OneLine(arguments.to), OneLine(arguments.db));
  return {};
}

}  // namespace

Action SetUpBackup(ArgumentParser& parser) {
  const auto arguments = std::make_shared<BackupArguments>();
  parser.Add("--db", arguments->db, "The index, a file, which others may read and write meanwhile")
      .Required()
      .TypeName("FILE");
  parser.Add("--to", arguments->to, "The copy, a new file, which its user only can read").Required().TypeName("FILE");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
