// SQLite as the store wants it: owned handles, errors as values, prepared statements kept for the next use.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "victorious/base/error.h"
#include "victorious/store/sqlite/statement.h"

struct sqlite3;

namespace victorious::sqlite {

/// How long a statement waits for another process that is writing.
inline constexpr std::chrono::seconds kBusyTimeout{10};

enum class Access {
  kCreate,     ///< read and write; the file is made if it is not there
  kWrite,      ///< read and write; the file must exist
  kRead,       ///< the file is not written; the files of its journal may be
  kImmutable,  ///< nothing is written or locked: only for a file that nobody can be writing
};

/// One open database. One thread at a time. Must outlive its statements.
class Connection {
 public:
  static Expected<std::unique_ptr<Connection>> Open(const std::filesystem::path& path, Access access);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// A prepared statement, new or kept from an earlier use; it comes back here when it is destroyed.
  Expected<Statement> Prepare(std::string_view sql);

  /// Runs all statements of `sql`, without results.
  Status Execute(const std::string& sql);

  /// The one text that `sql` selects.
  Expected<std::string> QueryText(std::string_view sql);

  [[nodiscard]] std::int64_t LastInsertId() const;
  /// Rows that the last statement inserted, changed or removed.
  [[nodiscard]] std::int64_t Changes() const;
  [[nodiscard]] bool IsInTransaction() const;
  /// True if the last call failed because another process holds the lock.
  [[nodiscard]] bool IsBusy() const;
  [[nodiscard]] const std::string& name() const { return name_; }

  /// What SQLite's result code means here, with the file's name.
  [[nodiscard]] Error ErrorFromCode(int code) const;

 private:
  friend class Statement;
  Connection(std::string name, sqlite3* handle) : name_(std::move(name)), handle_(handle) {}
  void Keep(const std::string& sql, sqlite3_stmt* statement);

  std::string name_;
  sqlite3* handle_;
  std::unordered_map<std::string, sqlite3_stmt*> idle_;
};

/// Everything from Begin to Commit, or nothing: what is not committed is rolled back at the end of the scope.
class Transaction {
 public:
  /// Takes the write lock at once, so that what is read inside cannot change before it is written.
  static Expected<Transaction> Begin(Connection& connection);
  ~Transaction();
  Transaction(Transaction&& other) noexcept : connection_(std::exchange(other.connection_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;

  Status Commit();

 private:
  explicit Transaction(Connection& connection) : connection_(&connection) {}

  Connection* connection_;
};

}  // namespace victorious::sqlite
