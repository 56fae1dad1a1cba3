#include "victorious/store/postgres/postgres_database.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {
namespace {

constexpr int kRowsAtOnce = 2000;
constexpr int kLargeRowsAtOnce = 8;  // a kept frame has some 0.3 MB

class PostgresDatabase final : public sql::Database {
 public:
  explicit PostgresDatabase(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}

  const std::string& name() const override { return connection_->name(); }
  sql::Dialect dialect() const override { return sql::Dialect::kPostgres; }

  Status HideFromOthers() override { return {}; }

  Status Visit(const std::string& sql, const sql::ValueList& values, sql::RowCount count,
               const std::function<Expected<bool>(const sql::Row&)>& visit) override {
    BoundValues bound;
    values.BindTo(bound);
    if (count != sql::RowCount::kFew) {
      const int at_once = count == sql::RowCount::kMany ? kRowsAtOnce : kLargeRowsAtOnce;
      return connection_->Visit(sql, bound, at_once, [&](const Result& row) { return visit(row); });
    }
    VICTORIOUS_ASSIGN_OR_RETURN(Result rows, connection_->Query(sql, bound));
    while (rows.Next()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool goes_on, visit(rows));
      if (!goes_on) break;
    }
    return {};
  }

  Expected<std::int64_t> Write(const std::string& sql, const sql::ValueList& values) override {
    VICTORIOUS_ASSIGN_OR_RETURN(sql::Change change, sql::Change::Begin(*this));
    BoundValues bound;
    values.BindTo(bound);
    VICTORIOUS_ASSIGN_OR_RETURN(const Result result, connection_->Query(sql, bound));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return result.Changes();
  }

  Status WriteRows(const std::string& sql, const sql::NewRows& rows) override {
    for (std::size_t row = 0; row < rows.count; ++row) {
      BoundValues values;
      rows.bind(row, values);
      VICTORIOUS_RETURN_IF_ERROR(connection_->Query(sql, values));
    }
    return {};
  }

  Status InsertRows(const std::string& table, const std::string& columns, const sql::NewRows& rows) override {
    if (rows.count == 0) return {};
    CopyRows copied;
    for (std::size_t row = 0; row < rows.count; ++row) {
      BoundValues values;
      rows.bind(row, values);
      copied.Add(values);
    }
    return connection_->Copy(fmt::format("{} ({})", table, columns), copied);
  }

  Status WriteFromRows(const std::string& table, const std::string& columns, const sql::NewRows& rows,
                       const std::string& sql) override {
    if (rows.count == 0) return {};
    VICTORIOUS_RETURN_IF_ERROR(connection_->Execute(
        fmt::format("CREATE TEMPORARY TABLE given ON COMMIT DROP AS SELECT {} FROM {} WITH NO DATA", columns, table)));
    VICTORIOUS_RETURN_IF_ERROR(InsertRows("given", columns, rows));
    return connection_->Execute(fmt::format("ANALYZE given; {}; DROP TABLE given", sql));
  }

  Status Begin(Exclusion exclusion) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, exclusion));
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
  return std::make_unique<PostgresDatabase>(std::move(connection));
}

Expected<std::unique_ptr<sql::Database>> OpenSqlDatabase(const std::string& url, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, OpenIndex(url, mode));
  return MakeSqlDatabase(std::move(connection));
}

}  // namespace victorious::postgres
