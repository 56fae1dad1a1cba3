// Rows and parameters in PostgreSQL's binary format: integers are bigint, numbers double precision, both big-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/store/sql/row.h"

struct pg_result;

namespace victorious::postgres {

/// The parameters of a statement, or the columns of a row of a COPY.
class BoundValues final : public sql::Parameters {
 public:
  struct Value {
    unsigned type = 0;                 ///< the type's id in PostgreSQL; 0: the server infers it
    std::optional<std::string> bytes;  ///< std::nullopt: NULL
  };

  using sql::Parameters::BindAt;
  void BindAt(int parameter, std::int64_t value) override;
  void BindAt(int parameter, double value) override;
  void BindAt(int parameter, std::string_view value) override;
  void BindAt(int parameter, std::span<const std::byte> value) override;
  void BindAt(int parameter, std::nullopt_t null) override;

  [[nodiscard]] const std::vector<Value>& values() const { return values_; }

 private:
  Value& At(int parameter);

  std::vector<Value> values_;
};

/// Rows for COPY … FROM STDIN (FORMAT binary). The types of the columns must be those of the values: COPY does not
/// convert.
class CopyRows {
 public:
  CopyRows();

  void Add(const BoundValues& row);
  template <typename... Values>
  void AddRow(const Values&... values) {
    BoundValues row;
    row.BindAll(values...);
    Add(row);
  }
  /// True if no row was added.
  [[nodiscard]] bool IsEmpty() const { return rows_ == 0; }
  /// The bytes of the header and the rows, without the end.
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t rows_ = 0;
};

/// The rows of a result, read one after the other.
class Result final : public sql::Row {
 public:
  explicit Result(pg_result* result) : result_(result) {}

  /// Steps to the next row, at first to the first. Returns false after the last one.
  [[nodiscard]] bool Next() { return ++row_ < RowCount(); }
  [[nodiscard]] int RowCount() const;
  /// Number of rows that the statement inserted, changed or deleted.
  [[nodiscard]] std::int64_t Changes() const;

  [[nodiscard]] bool IsNull(int column) const override;
  [[nodiscard]] std::int64_t Integer(int column) const override;  ///< a boolean reads as 0 or 1
  [[nodiscard]] double Real(int column) const override;
  [[nodiscard]] std::string Text(int column) const override;
  [[nodiscard]] std::span<const std::byte> Blob(int column) const override;

 private:
  struct Clear {
    void operator()(pg_result* result) const;
  };

  std::unique_ptr<pg_result, Clear> result_;
  int row_ = -1;
};

}  // namespace victorious::postgres
