#include "victorious/store/sqlite/sqlite_database.h"

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "victorious/store/sql/column_list.h"
#include "victorious/store/sqlite/open_database.h"

namespace victorious::sqlite {
namespace {

class SqliteDatabase final : public sql::Database {
 public:
  explicit SqliteDatabase(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}

  const std::string& name() const override { return connection_->name(); }
  sql::Dialect dialect() const override { return sql::Dialect::kSqlite; }

  // Of the log files, too, which SQLite makes with the permissions of the database.
  Status HideFromOthers() override {
    constexpr auto kOfUser = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
    for (const char* const suffix : {"", "-wal", "-shm", "-journal"}) {
      std::error_code error;
      std::filesystem::permissions(name() + suffix, kOfUser, error);
      if (error && error != std::errc::no_such_file_or_directory) {
        return std::unexpected(ErrorFromErrno(error.value(), "make " + name() + suffix + " private"));
      }
    }
    return {};
  }

  Status Visit(const std::string& sql, const sql::ValueList& values, sql::RowCount /*rows*/,
               const std::function<Expected<bool>(const sql::Row&)>& visit) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement statement, connection_->Prepare(sql));
    values.BindTo(statement);
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, statement.Step());
      if (!has_row) return {};
      VICTORIOUS_ASSIGN_OR_RETURN(const bool goes_on, visit(statement));
      if (!goes_on) return {};
    }
  }

  Expected<std::int64_t> Write(const std::string& sql, const sql::ValueList& values) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement statement, connection_->Prepare(sql));
    values.BindTo(statement);
    VICTORIOUS_RETURN_IF_ERROR(statement.Run());
    return connection_->Changes();
  }

  Status WriteRows(const std::string& sql, const sql::NewRows& rows) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement statement, connection_->Prepare(sql));
    for (std::size_t row = 0; row < rows.count; ++row) {
      rows.bind(row, statement);
      VICTORIOUS_RETURN_IF_ERROR(statement.Run());
    }
    return {};
  }

  Status InsertRows(const std::string& table, const std::string& columns, const sql::NewRows& rows) override {
    return WriteRows(sql::InsertInto(table, columns), rows);
  }

  Status WriteFromRows(const std::string& /*table*/, const std::string& columns, const sql::NewRows& rows,
                       const std::string& sql) override {
    return WriteRows(fmt::format("WITH given ({}) AS (VALUES ({})) {}", columns, sql::ParametersOf(columns), sql),
                     rows);
  }

  Status Begin(sql::Exclusion /*exclusion*/) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    transaction_.emplace(std::move(transaction));
    return {};
  }

  Status BeginReading() override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::BeginReading(*connection_));
    transaction_.emplace(std::move(transaction));
    return {};
  }

  Status Commit() override {
    const Status committed = transaction_->Commit();
    transaction_.reset();
    return committed;
  }

  void RollBack() override { transaction_.reset(); }
  bool IsInTransaction() const override { return transaction_.has_value(); }

 private:
  std::shared_ptr<Connection> connection_;
  std::optional<Transaction> transaction_;
};

}  // namespace

std::unique_ptr<sql::Database> MakeSqlDatabase(std::shared_ptr<Connection> connection) {
  return std::make_unique<SqliteDatabase>(std::move(connection));
}

Expected<std::unique_ptr<sql::Database>> OpenSqlDatabase(const std::filesystem::path& path, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, OpenDatabase(path, mode));
  return MakeSqlDatabase(std::move(connection));
}

}  // namespace victorious::sqlite
