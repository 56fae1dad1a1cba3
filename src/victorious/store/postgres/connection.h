// A connection to a PostgreSQL server: RAII handles, errors as values.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "victorious/base/error.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/values.h"
#include "victorious/store/sql/database.h"
#include "victorious/store/work_state.h"

struct pg_conn;

namespace victorious::postgres {

/// The schema of the tables, the first in the search path of every connection.
inline constexpr std::string_view kSchemaName = "victorious";

/// See victorious::TakePassword. Also takes the parameter `password` of a URL.
[[nodiscard]] StoreAddress TakePassword(const std::string& url);

/// Returns the database of a URL for messages: "postgresql://user@host:5432/name", without password and parameters; the
/// text itself if it is not a URL.
[[nodiscard]] std::string DatabaseName(const std::string& url);

/// An open database. Use from one thread at a time.
///
/// A connection that the server or the network ended is opened again by the next statement outside a transaction;
/// inside one, the statement is an error, because what the transaction did is gone.
class Connection {
 public:
  /// @param url  "postgresql://user@host:port/database?parameter=value", as libpq reads it (TLS: sslmode and others);
  ///             what it does not say comes from PGPASSWORD, ~/.pgpass and the like. Connects within 10 s, unless
  ///             connect_timeout says otherwise.
  /// @param is_read_only  the server refuses to write
  /// @param settings  of the session on the server: "-c name=value …"
  /// @param task  for which a worker's process writes: its transactions that change the index (kShared, kAll) are
  ///              refused with kConflict once that attempt does not run any more, and commit before another one begins
  /// Errors: kInvalidArgument (not a URL); kNotFound (no such server or database; for a task, kUnavailable if nothing
  /// answers: the server was there when the worker claimed it); kPermissionDenied (role, password); kUnsupported (older
  /// than PostgreSQL 15, or a database not in UTF-8).
  [[nodiscard]] static Expected<std::unique_ptr<Connection>> Open(const std::string& url, bool is_read_only,
                                                                  std::string_view settings = {},
                                                                  std::optional<TaskAttempt> task = {});
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Runs one statement. `sql` contains one "?" for each parameter. Outside a transaction it must only read, because it
  /// is run again if the connection was lost.
  [[nodiscard]] Expected<Result> Query(std::string_view sql, const BoundValues& parameters);
  template <typename... Values>
  [[nodiscard]] Expected<Result> Query(std::string_view sql, const Values&... values) {
    BoundValues parameters;
    parameters.BindAll(values...);
    return Query(sql, parameters);
  }

  /// Runs one statement that writes, as a transaction of its own, in one round trip; the server keeps its plan. If the
  /// connection is lost while it runs, that is an error, and it may have taken effect.
  [[nodiscard]] Expected<Result> Write(std::string_view sql, const BoundValues& parameters);
  template <typename... Values>
  [[nodiscard]] Expected<Result> Write(std::string_view sql, const Values&... values) {
    BoundValues parameters;
    parameters.BindAll(values...);
    return Write(sql, parameters);
  }

  /// Runs all statements of `sql`; ignores their results. The same rule outside a transaction.
  [[nodiscard]] Status Execute(const std::string& sql);

  /// Sends rows to `target`, "table (columns)".
  [[nodiscard]] Status Copy(std::string_view target, const CopyRows& rows);

  /// Visits the rows of a query through a cursor, `rows_at_once` held in memory; `visit` returns false to stop. It may
  /// query this connection, and must not write.
  [[nodiscard]] Status Visit(std::string_view sql, const BoundValues& parameters, int rows_at_once,
                             const std::function<Expected<bool>(const Result&)>& visit);

  /// From now on a statement that the server does not answer in this time is an error (kUnavailable), and the
  /// connection lost. Without it, a server that stands still is waited for.
  void SetReplyTimeout(std::chrono::milliseconds timeout) { reply_timeout_ = timeout; }

  /// For messages: DatabaseName(url).
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  friend class Transaction;
  Connection(std::string name, pg_conn* handle, std::optional<TaskAttempt> task)
      : name_(std::move(name)), handle_(handle), task_(task) {}

  /// After a failed attempt: connects once more, or says why not.
  [[nodiscard]] Status ConnectAgain(const std::string& url);
  [[nodiscard]] Status CheckServer() const;
  /// Sets what a new session needs.
  [[nodiscard]] Status PrepareSession();
  [[nodiscard]] Status Reconnect();
  [[nodiscard]] bool IsLost() const;
  /// Reads what the server has said unasked, as that it ends; IsLost() then knows.
  void ReadNotices();
  /// Returns the name of the statement on this connection, which is prepared at first.
  [[nodiscard]] Expected<std::string> Prepare(std::string_view sql, const BoundValues& parameters);
  /// Waits until the results of what was sent can be read. False: the time is over, and the connection lost.
  [[nodiscard]] bool AwaitReply();
  /// Error: kConflict if the task's attempt does not run any more. Until the transaction ends, no other one begins.
  [[nodiscard]] Status CheckTask();
  /// Waits for the results of what was sent; the last one, or the first error.
  [[nodiscard]] Expected<Result> Finish();
  [[nodiscard]] Error ErrorFromResult(const pg_result* result) const;
  /// Runs `send`, and Finish(); once more on a new connection, if this one was lost outside a transaction.
  [[nodiscard]] Expected<Result> Run(const std::function<bool()>& send);
  [[nodiscard]] Status VisitCursor(const std::string& cursor, int rows_at_once,
                                   const std::function<Expected<bool>(const Result&)>& visit);

  std::string name_;
  pg_conn* handle_;
  std::optional<TaskAttempt> task_;
  std::optional<std::chrono::milliseconds> reply_timeout_;
  bool is_silent_ = false;  ///< a reply did not come in time
  bool is_in_transaction_ = false;
  int cursors_ = 0;                                           ///< open visits
  std::map<std::string, std::string, std::less<>> prepared_;  ///< names by statement
};

using sql::Exclusion;

/// An RAII transaction: the destructor rolls back unless Commit was called. The server ends it if the
/// process stands still for a minute, so that others do not wait for it.
class Transaction {
 public:
  [[nodiscard]] static Expected<Transaction> Begin(Connection& connection, Exclusion exclusion);
  /// It only reads: all of it the database as it is at its first statement.
  [[nodiscard]] static Expected<Transaction> BeginReading(Connection& connection);
  ~Transaction();
  Transaction(Transaction&& other) noexcept : connection_(std::exchange(other.connection_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;

  [[nodiscard]] Status Commit();

 private:
  explicit Transaction(Connection& connection) : connection_(&connection) {}

  Connection* connection_;
};

}  // namespace victorious::postgres
