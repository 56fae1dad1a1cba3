// A prepared SQL statement.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "victorious/base/error.h"

struct sqlite3_stmt;

namespace victorious::sqlite {

class Connection;

/// Usage: bind, step through the rows, read columns (from 0). The destructor resets the statement and returns it to its
/// connection, so that it holds no lock between uses.
class Statement {
 public:
  ~Statement();
  Statement(Statement&& other) noexcept
      : connection_(other.connection_),
        sql_(std::move(other.sql_)),
        handle_(std::exchange(other.handle_, nullptr)),
        bind_code_(other.bind_code_) {}
  Statement& operator=(Statement&&) = delete;

  /// Binds parameters 1, 2, …. The next Step reports a failure.
  template <typename... Values>
  Statement& Bind(const Values&... values) {
    int parameter = 0;
    (BindAt(++parameter, values), ...);
    return *this;
  }
  void BindAt(int parameter, std::int64_t value);
  void BindAt(int parameter, int value) { BindAt(parameter, std::int64_t{value}); }
  void BindAt(int parameter, double value);
  void BindAt(int parameter, std::string_view value);
  void BindAt(int parameter, const std::string& value) { BindAt(parameter, std::string_view(value)); }
  void BindAt(int parameter, std::span<const std::byte> value);
  void BindAt(int parameter, std::nullopt_t null);
  template <typename T>
  void BindAt(int parameter, const std::optional<T>& value) {
    value ? BindAt(parameter, *value) : BindAt(parameter, std::nullopt);
  }

  /// Returns true if a row is available, false after the last row.
  [[nodiscard]] Expected<bool> Step();
  /// Steps to the end and resets the statement for the next Bind.
  [[nodiscard]] Status Run();

  [[nodiscard]] bool IsNull(int column) const;
  [[nodiscard]] std::int64_t Integer(int column) const;
  [[nodiscard]] double Real(int column) const;
  [[nodiscard]] std::string Text(int column) const;
  /// Valid until the next Step.
  [[nodiscard]] std::span<const std::byte> Blob(int column) const;
  [[nodiscard]] std::optional<std::int64_t> OptionalInteger(int column) const;
  [[nodiscard]] std::optional<double> OptionalReal(int column) const;

 private:
  friend class Connection;
  Statement(Connection& connection, std::string sql, sqlite3_stmt* handle)
      : connection_(&connection), sql_(std::move(sql)), handle_(handle) {}
  void RecordBindError(int code);

  Connection* connection_;
  std::string sql_;
  sqlite3_stmt* handle_;
  int bind_code_ = 0;
};

}  // namespace victorious::sqlite
