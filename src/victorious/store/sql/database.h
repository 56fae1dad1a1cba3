// A SQL database, as it is used by the stores whose statements are the same in SQLite and PostgreSQL (sql_*.cc).
// sqlite/ and postgres/ implement it. Where the two differ, dialect.h has the words of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sql/dialect.h"
#include "victorious/store/sql/row.h"

namespace victorious::sql {

/// The values of a statement's parameters.
class ValueList final : public Parameters {
 public:
  template <typename... Values>
  explicit ValueList(const Values&... values) {
    BindAll(values...);
  }

  using Parameters::BindAt;
  void BindAt(int parameter, std::int64_t value) override { At(parameter) = value; }
  void BindAt(int parameter, double value) override { At(parameter) = value; }
  void BindAt(int parameter, std::string_view value) override { At(parameter) = std::string(value); }
  void BindAt(int parameter, std::span<const std::byte> value) override {
    At(parameter) = std::vector<std::byte>(value.begin(), value.end());
  }
  void BindAt(int parameter, std::nullopt_t null) override { At(parameter) = null; }

  /// Binds the values in their order.
  void BindTo(Parameters& parameters) const;

 private:
  using Value = std::variant<std::nullopt_t, std::int64_t, double, std::string, std::vector<std::byte>>;

  Value& At(int parameter);

  std::vector<Value> values_;
};

/// How many rows a query is expected to have.
enum class RowCount {
  kFew,        ///< held in memory
  kMany,       ///< read in portions
  kManyLarge,  ///< of many kilobytes each: read in small portions
};

/// What a transaction excludes until it ends. One of SQLite excludes all others.
enum class Exclusion {
  kNothing,  ///< for writes that lock their rows by themselves
  kShared,   ///< kAll of other processes, not their kShared: for writes that touch only rows of their own
  kAll,      ///< all other writes of the index: for what changes rows that others write, too
  kServer,   ///< kServer of other processes: for what servers alone write; no indexer waits for it
};

/// Rows that the program writes.
struct NewRows {
  std::size_t count = 0;
  std::function<void(std::size_t row, Parameters& values)> bind;  ///< gives the values of a row
};

/// What a reader of rows returns, or what it returns unless it fails.
template <typename T>
struct ReadResult {
  using Record = T;
};
template <typename T>
struct ReadResult<Expected<T>> {
  using Record = T;
};
template <typename Read>
using RecordOf = typename ReadResult<std::invoke_result_t<const Read&, const Row&>>::Record;

/// Use from one thread at a time. Statements have one "?" for each parameter.
class Database {
 public:
  virtual ~Database() = default;

  /// For messages: the file, or the URL without password and parameters.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual Dialect dialect() const = 0;

  /// Leaves the files of a database that is one to its user; a server has its own rights.
  [[nodiscard]] virtual Status HideFromOthers() = 0;

  /// Visits the rows of a statement: of a query, or of one that writes inside a transaction, with RETURNING. `visit`
  /// returns false to stop, which a statement that writes must not.
  [[nodiscard]] virtual Status Visit(const std::string& sql, const ValueList& values, RowCount rows,
                                     const std::function<Expected<bool>(const Row&)>& visit) = 0;
  /// Runs a statement that writes: inside the present transaction, or as one of its own. Returns the number of rows
  /// that it inserted, changed or deleted.
  [[nodiscard]] virtual Expected<std::int64_t> Write(const std::string& sql, const ValueList& values) = 0;

  /// Runs a statement that writes once for each row, whose values are its parameters. Inside a transaction, as the two
  /// that follow.
  [[nodiscard]] virtual Status WriteRows(const std::string& sql, const NewRows& rows) = 0;
  /// Adds rows to a table.
  /// @param columns  "x, y"
  [[nodiscard]] virtual Status InsertRows(const std::string& table, const std::string& columns,
                                          const NewRows& rows) = 0;
  /// Runs a statement that reads the rows from a table `given` with these columns of `table`: once for all rows, or
  /// once for each.
  [[nodiscard]] virtual Status WriteFromRows(const std::string& table, const std::string& columns, const NewRows& rows,
                                             const std::string& sql) = 0;

  /// Begins a transaction.
  [[nodiscard]] virtual Status Begin(Exclusion exclusion) = 0;
  /// Begins a transaction that only reads, and reads the database as it is at one moment. It waits for nobody, and
  /// nobody waits for it.
  [[nodiscard]] virtual Status BeginReading() = 0;
  [[nodiscard]] virtual Status Commit() = 0;
  virtual void RollBack() = 0;
  [[nodiscard]] virtual bool IsInTransaction() const = 0;

  /// The first row of a statement, as `read` converts it; std::nullopt: it has none. `read` may fail.
  template <typename Read>
  [[nodiscard]] Expected<std::optional<RecordOf<Read>>> ReadOne(const std::string& sql, const ValueList& values,
                                                                const Read& read) {
    std::optional<RecordOf<Read>> found;
    VICTORIOUS_RETURN_IF_ERROR(Visit(sql, values, RowCount::kFew, [&](const Row& row) -> Expected<bool> {
      if (found) return true;
      VICTORIOUS_ASSIGN_OR_RETURN(found, Expected<RecordOf<Read>>(read(row)));
      return true;
    }));
    return found;
  }

  /// All rows of a query, as `read` converts them. `read` may fail.
  template <typename Read>
  [[nodiscard]] Expected<std::vector<RecordOf<Read>>> ReadAll(const std::string& sql, const ValueList& values,
                                                              const Read& read) {
    std::vector<RecordOf<Read>> records;
    VICTORIOUS_RETURN_IF_ERROR(Visit(sql, values, RowCount::kFew, [&](const Row& row) -> Expected<bool> {
      VICTORIOUS_ASSIGN_OR_RETURN(auto record, Expected<RecordOf<Read>>(read(row)));
      records.push_back(std::move(record));
      return true;
    }));
    return records;
  }

  /// The number that a query gives in its first row.
  [[nodiscard]] Expected<std::int64_t> ReadInteger(const std::string& sql, const ValueList& values);
};

/// A transaction, or a part of the one that has begun already. The destructor rolls back unless Commit was called.
class Change {
 public:
  /// By default it excludes those of all other servers, so that what it has read does not change.
  [[nodiscard]] static Expected<Change> Begin(Database& database, Exclusion exclusion = Exclusion::kServer);
  /// One that only reads (Database::BeginReading).
  [[nodiscard]] static Expected<Change> BeginReading(Database& database);
  ~Change() {
    if (database_ != nullptr) database_->RollBack();
  }
  Change(Change&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Change& operator=(Change&&) = delete;

  [[nodiscard]] Status Commit();

 private:
  explicit Change(Database* database) : database_(database) {}

  Database* database_;  ///< null: part of another transaction, or ended
};

/// Opens the file or the database that OpenStore opens. Errors: those of OpenStore.
[[nodiscard]] Expected<std::unique_ptr<Database>> OpenDatabase(const std::string& name, StoreMode mode);

}  // namespace victorious::sql
