// What a SQL database gives and takes: the columns of a row of a result, and the parameters of a statement. sqlite/ and
// postgres/ implement both; records.h and conditions.h convert to and from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious::sql {

/// The present row of a result. Columns count from 0. A NULL reads as 0, an empty text or no bytes.
class Row {
 public:
  virtual ~Row() = default;

  [[nodiscard]] virtual bool IsNull(int column) const = 0;
  [[nodiscard]] virtual std::int64_t Integer(int column) const = 0;
  [[nodiscard]] virtual double Real(int column) const = 0;
  [[nodiscard]] virtual std::string Text(int column) const = 0;
  /// Valid until the next row.
  [[nodiscard]] virtual std::span<const std::byte> Blob(int column) const = 0;

  [[nodiscard]] std::optional<std::int64_t> OptionalInteger(int column) const {
    return IsNull(column) ? std::nullopt : std::optional(Integer(column));
  }
  [[nodiscard]] std::optional<double> OptionalReal(int column) const {
    return IsNull(column) ? std::nullopt : std::optional(Real(column));
  }

 protected:
  Row() = default;
  Row(const Row&) = default;
  Row& operator=(const Row&) = default;
};

/// The parameters of a statement, from 1. Values are copied.
class Parameters {
 public:
  virtual ~Parameters() = default;

  virtual void BindAt(int parameter, std::int64_t value) = 0;
  virtual void BindAt(int parameter, double value) = 0;
  virtual void BindAt(int parameter, std::string_view value) = 0;
  virtual void BindAt(int parameter, std::span<const std::byte> value) = 0;
  virtual void BindAt(int parameter, std::nullopt_t null) = 0;
  void BindAt(int parameter, int value) { BindAt(parameter, std::int64_t{value}); }
  void BindAt(int parameter, const std::string& value) { BindAt(parameter, std::string_view(value)); }
  template <typename T>
  void BindAt(int parameter, const std::optional<T>& value) {
    value ? BindAt(parameter, *value) : BindAt(parameter, std::nullopt);
  }

  /// Binds parameters 1, 2, ….
  template <typename... Values>
  void BindAll(const Values&... values) {
    int parameter = 0;
    (BindAt(++parameter, values), ...);
  }

 protected:
  Parameters() = default;
  Parameters(const Parameters&) = default;
  Parameters& operator=(const Parameters&) = default;
};

/// The error of an index whose content is not valid: kDataLoss with the index's name, the fault and what to do.
[[nodiscard]] Error DamagedIndex(std::string_view name, std::string_view fault);

/// Whether this program reads an index of this schema version.
/// @param newest  version that the program writes; it reads 1 to `newest`
/// Errors: kUnsupported if a newer program wrote it; that of DamagedIndex below 1.
[[nodiscard]] Status CheckSchemaVersion(std::string_view name, std::int64_t version, std::int64_t newest);

}  // namespace victorious::sql
