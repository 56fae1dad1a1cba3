#include "victorious/store/sql/conditions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace victorious::sql {

void Conditions::Append(std::string_view expression) {
  text_ += text_.empty() ? "WHERE " : "AND ";
  text_ += expression;
  text_ += ' ';
}

void Conditions::AddOneOf(std::string_view column, const std::vector<std::int64_t>& ids) {
  Append(ids.empty() ? "1 = 0" : fmt::format("{} IN ({})", column, fmt::join(ids, ", ")));
}

void Conditions::AddQuery(std::string_view expression, const Conditions& query) {
  if (query.text_.empty()) return;
  Append(fmt::format(fmt::runtime(expression), query.text_));
  values_.insert(values_.end(), query.values_.begin(), query.values_.end());
}

std::string Conditions::Expression() const {
  constexpr std::string_view kWhere = "WHERE ";
  return text_.empty() ? "1" : "(" + text_.substr(kWhere.size()) + ")";
}

int Conditions::Bind(Parameters& parameters, int first) const {
  int parameter = first;
  for (const auto& value : values_) {
    std::visit([&](const auto& held) { parameters.BindAt(parameter, held); }, value);
    ++parameter;
  }
  return parameter;
}

ValueList ValuesOf(const Conditions& conditions) {
  ValueList values;
  conditions.Bind(values);
  return values;
}

}  // namespace victorious::sql
