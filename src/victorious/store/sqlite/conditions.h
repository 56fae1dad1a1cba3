// The WHERE of a query, made of the conditions that a SightingFilter sets.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "victorious/store/sqlite/statement.h"

namespace victorious::sqlite {

class Conditions {
 public:
  /// `expression` has one "?", which `value` fills.
  template <typename T>
  void Add(std::string_view expression, const T& value) {
    Append(expression);
    values_.emplace_back(value);
  }
  /// `column` must be one of `ids`.
  void AddOneOf(std::string_view column, const std::vector<std::int64_t>& ids);

  /// `expression` has one "{}", in which the query's own conditions stand; nothing where there are none.
  void AddQuery(std::string_view expression, const Conditions& query);

  /// "WHERE … AND … ", or nothing.
  [[nodiscard]] const std::string& text() const { return text_; }
  void Bind(Statement& statement) const;

 private:
  void Append(std::string_view expression);

  std::string text_;
  std::vector<std::variant<std::int64_t, double, std::string>> values_;
};

}  // namespace victorious::sqlite
