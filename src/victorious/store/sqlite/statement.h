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
#include "victorious/store/sql/row.h"

struct sqlite3_stmt;

namespace victorious::sqlite {

class Connection;

/// Usage: bind, step through the rows, read columns. The destructor resets the statement and returns it to its
/// connection, so that it holds no lock between uses.
class Statement final : public sql::Row, public sql::Parameters {
 public:
  ~Statement() override;
  Statement(Statement&& other) noexcept
      : connection_(other.connection_),
        sql_(std::move(other.sql_)),
        handle_(std::exchange(other.handle_, nullptr)),
        bind_code_(other.bind_code_) {}
  Statement& operator=(Statement&&) = delete;

  /// Binds parameters 1, 2, …. The next Step reports a failure.
  template <typename... Values>
  Statement& Bind(const Values&... values) {
    BindAll(values...);
    return *this;
  }
  using sql::Parameters::BindAt;
  void BindAt(int parameter, std::int64_t value) override;
  void BindAt(int parameter, double value) override;
  void BindAt(int parameter, std::string_view value) override;
  void BindAt(int parameter, std::span<const std::byte> value) override;
  void BindAt(int parameter, std::nullopt_t null) override;

  /// Returns true if a row is available, false after the last row.
  [[nodiscard]] Expected<bool> Step();
  /// Steps to the end and resets the statement for the next Bind.
  [[nodiscard]] Status Run();

  [[nodiscard]] bool IsNull(int column) const override;
  [[nodiscard]] std::int64_t Integer(int column) const override;
  [[nodiscard]] double Real(int column) const override;
  [[nodiscard]] std::string Text(int column) const override;
  /// Valid until the next Step.
  [[nodiscard]] std::span<const std::byte> Blob(int column) const override;

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
