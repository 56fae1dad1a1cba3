// Builds the WHERE clause of a query from the conditions of a SightingFilter.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "victorious/store/sql/database.h"
#include "victorious/store/sql/row.h"

namespace victorious::sql {

class Conditions {
 public:
  /// `expression` contains one "?" for each of `values`.
  template <typename... Values>
  void Add(std::string_view expression, const Values&... values) {
    Append(expression);
    (values_.emplace_back(values), ...);
  }
  /// Requires `column` to be one of `ids`; none: nothing matches.
  void AddOneOf(std::string_view column, const std::vector<std::int64_t>& ids);

  /// `expression` contains one "{}", replaced by the WHERE clause of `query`. Adds nothing if `query` is empty.
  void AddQuery(std::string_view expression, const Conditions& query);

  /// "WHERE … AND … ", or empty.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// The conditions as one expression; "1" if there is none.
  [[nodiscard]] std::string Expression() const;
  /// Binds the values from parameter `first` on. Returns the first parameter after them.
  int Bind(Parameters& parameters, int first = 1) const;

 private:
  void Append(std::string_view expression);

  std::string text_;
  std::vector<std::variant<std::int64_t, double, std::string>> values_;
};

/// The values of the conditions alone.
[[nodiscard]] ValueList ValuesOf(const Conditions& conditions);

}  // namespace victorious::sql
