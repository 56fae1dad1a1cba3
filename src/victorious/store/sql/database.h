// A SQL database, as it is used by the stores whose statements are the same in SQLite and PostgreSQL: accounts, jobs,
// thresholds and triage (sql_*_store.cc). sqlite/ and postgres/ implement it. Where the two differ, dialect.h has the
// words of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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
  kFew,   ///< held in memory
  kMany,  ///< read in portions
};

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

  /// Begins a transaction. It excludes those of all others that write by this interface, so that what it has read does
  /// not change.
  [[nodiscard]] virtual Status Begin() = 0;
  [[nodiscard]] virtual Status Commit() = 0;
  virtual void RollBack() = 0;
  [[nodiscard]] virtual bool IsInTransaction() const = 0;

  /// The first row of a statement, as `read` converts it; std::nullopt: it has none.
  template <typename Read>
  auto ReadOne(const std::string& sql, const ValueList& values, const Read& read)
      -> Expected<std::optional<typename decltype(read(std::declval<const Row&>()))::value_type>> {
    std::optional<typename decltype(read(std::declval<const Row&>()))::value_type> found;
    VICTORIOUS_RETURN_IF_ERROR(Visit(sql, values, RowCount::kFew, [&](const Row& row) -> Expected<bool> {
      if (found) return true;
      VICTORIOUS_ASSIGN_OR_RETURN(found, read(row));
      return true;
    }));
    return found;
  }

  /// All rows of a query, as `read` converts them.
  template <typename Read>
  auto ReadAll(const std::string& sql, const ValueList& values, const Read& read)
      -> Expected<std::vector<typename decltype(read(std::declval<const Row&>()))::value_type>> {
    std::vector<typename decltype(read(std::declval<const Row&>()))::value_type> records;
    VICTORIOUS_RETURN_IF_ERROR(Visit(sql, values, RowCount::kFew, [&](const Row& row) -> Expected<bool> {
      VICTORIOUS_ASSIGN_OR_RETURN(auto record, read(row));
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
  [[nodiscard]] static Expected<Change> Begin(Database& database);
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
