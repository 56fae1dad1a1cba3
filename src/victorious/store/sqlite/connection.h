// A SQLite connection: RAII handles, errors as values, cached prepared statements.
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

/// How long a statement waits for the write lock of another process.
inline constexpr std::chrono::seconds kBusyTimeout{10};

enum class Access {
  kCreate,     ///< read and write; creates the file if it does not exist
  kWrite,      ///< read and write; the file must exist
  kRead,       ///< does not write the file; may write its journal files
  kImmutable,  ///< no writes, no locks: only for a file that no process can be writing
};

using sql::DamagedIndex;

/// An open database. Use from one thread at a time. Must outlive its statements.
class Connection {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<Connection>> Open(const std::filesystem::path& path, Access access);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Returns a prepared statement, new or from the cache. Its destructor returns it to the cache.
  [[nodiscard]] Expected<Statement> Prepare(std::string_view sql);

  /// Executes all statements of `sql`; ignores their results.
  [[nodiscard]] Status Execute(const std::string& sql);

  /// Returns the single text value that `sql` selects.
  [[nodiscard]] Expected<std::string> QueryText(std::string_view sql);

  /// Number of rows that the last statement inserted, changed or deleted.
  [[nodiscard]] std::int64_t Changes() const;
  [[nodiscard]] bool IsInTransaction() const;
  /// True if the last call failed because another process holds the lock.
  [[nodiscard]] bool IsBusy() const;
  [[nodiscard]] const std::string& name() const { return name_; }
  /// For what SQLite does with two connections (backup.h).
  [[nodiscard]] sqlite3* handle() const { return handle_; }

  /// Converts a SQLite result code to an Error with the file's name.
  [[nodiscard]] Error ErrorFromCode(int code) const;

 private:
  friend class Statement;
  Connection(std::string name, sqlite3* handle) : name_(std::move(name)), handle_(handle) {}
  void ReturnToCache(const std::string& sql, sqlite3_stmt* statement);

  std::string name_;
  sqlite3* handle_;
  std::unordered_map<std::string, sqlite3_stmt*> statement_cache_;
};

/// An RAII transaction: the destructor rolls back unless Commit was called.
class Transaction {
 public:
  /// Takes the write lock immediately, so that values read inside cannot change before they are written.
  [[nodiscard]] static Expected<Transaction> Begin(Connection& connection);
  /// Takes no lock of writers: what it reads is the file as it is at its first statement.
  [[nodiscard]] static Expected<Transaction> BeginReading(Connection& connection);
  ~Transaction();
  Transaction(Transaction&& other) noexcept : connection_(std::exchange(other.connection_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;

  [[nodiscard]] Status Commit();

 private:
  explicit Transaction(Connection& connection) : connection_(&connection) {}

  Connection* connection_;
};

}  // namespace victorious::sqlite
