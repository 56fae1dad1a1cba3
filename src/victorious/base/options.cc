#include "victorious/base/options.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

using nlohmann::json;

template <typename... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

json ValueToJson(const FieldRef& field) {
  return std::visit([](const auto* value) { return json(*value); }, field.value);
}

std::string RangeText(const FieldSpec& spec) {
  if (!spec.choices.empty()) return fmt::format("one of {}", fmt::join(spec.choices, ", "));
  const bool low = std::isfinite(spec.min);
  const bool high = std::isfinite(spec.max);
  if (low && high) return fmt::format("{:g} to {:g}", spec.min, spec.max);
  if (low) return fmt::format("at least {:g}", spec.min);
  if (high) return fmt::format("at most {:g}", spec.max);
  return "any";
}

std::string_view TypeText(const FieldRef& field) {
  return std::visit(Overloaded{[](const double*) { return "a number"; }, [](const int*) { return "a whole number"; },
                               [](const bool*) { return "true or false"; },
                               [](const std::uint64_t*) { return "a whole number, at least 0"; },
                               [](const std::string*) { return "text"; }},
                    field.value);
}

// The constraint that `value` violates, or nothing.
std::string Violation(const FieldRef& field, const json& value) {
  const FieldSpec& spec = field.spec;
  const bool type_fits = std::visit(Overloaded{[&](const double*) { return value.is_number(); },
                                               [&](const int*) {
                                                 return value.is_number_integer() &&
                                                        value >= std::numeric_limits<int>::min() &&
                                                        value <= std::numeric_limits<int>::max();
                                               },
                                               [&](const bool*) { return value.is_boolean(); },
                                               [&](const std::uint64_t*) { return value.is_number_unsigned(); },
                                               [&](const std::string*) { return value.is_string(); }},
                                    field.value);
  if (!type_fits) return fmt::format("{} = {}: must be {}", field.name, value.dump(), TypeText(field));
  if (value.is_number()) {
    const double number = value.get<double>();
    if (!(number >= spec.min && number <= spec.max)) {
      return fmt::format("{} = {}: must be {}", field.name, value.dump(), RangeText(spec));
    }
  }
  if (value.is_string() && !spec.choices.empty() &&
      std::ranges::find(spec.choices, value.get<std::string>()) == spec.choices.end()) {
    return fmt::format("{} = {}: must be {}", field.name, value.dump(), RangeText(spec));
  }
  return {};
}

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

std::string UnknownName(const std::string& name, const std::vector<FieldRef>& fields) {
  const auto nearest =
      std::ranges::min_element(fields, {}, [&](const FieldRef& field) { return EditDistance(field.name, name); });
  return nearest == fields.end() ? fmt::format("{}: unknown parameter", name)
                                 : fmt::format("{}: unknown parameter; the nearest is {}", name, nearest->name);
}

// Flattens {"match": {"ratio": 0.8}} and {"match.ratio": 0.8} alike.
void Flatten(const json& node, const std::string& prefix, std::vector<std::pair<std::string, json>>& out) {
  for (const auto& [key, value] : node.items()) {
    const std::string name = prefix.empty() ? key : prefix + "." + key;
    if (value.is_object()) {
      Flatten(value, name, out);
    } else {
      out.emplace_back(name, value);
    }
  }
}

void Assign(const FieldRef& field, const json& value) {
  std::visit([&]<typename T>(T* target) { *target = value.get<T>(); }, field.value);
}

Status Report(const std::vector<std::string>& violations) {
  if (violations.empty()) return {};
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}", fmt::join(violations, "; ")));
}

}  // namespace

nlohmann::json ToJson(const std::vector<FieldRef>& fields) {
  json root = json::object();
  for (const FieldRef& field : fields) {
    json* node = &root;
    std::string_view rest = field.name;
    for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
      node = &(*node)[std::string(rest.substr(0, dot))];
      rest.remove_prefix(dot + 1);
    }
    (*node)[std::string(rest)] = ValueToJson(field);
  }
  return root;
}

std::string ToJsonText(const std::vector<FieldRef>& fields) { return ToJson(fields).dump(); }

Status SetFromJson(const nlohmann::json& values, const std::vector<FieldRef>& fields) {
  if (!values.is_object()) {
    return Fail(ErrorCode::kInvalidArgument, "parameters must be a JSON object of names and values");
  }
  std::vector<std::pair<std::string, json>> flat;
  Flatten(values, "", flat);
  std::vector<std::string> violations;
  for (const auto& [name, value] : flat) {
    const auto field = std::ranges::find(fields, name, &FieldRef::name);
    if (field == fields.end()) {
      violations.push_back(UnknownName(name, fields));
    } else if (std::string violation = Violation(*field, value); !violation.empty()) {
      violations.push_back(std::move(violation));
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(Report(violations));
  for (const auto& [name, value] : flat) Assign(*std::ranges::find(fields, name, &FieldRef::name), value);
  return {};
}

Status Validate(const std::vector<FieldRef>& fields) {
  std::vector<std::string> violations;
  for (const FieldRef& field : fields) {
    const json value = ValueToJson(field);
    // NaN and infinities have no JSON form: they show as null there, and violate every range here.
    if (std::string violation = Violation(field, value); !violation.empty()) violations.push_back(std::move(violation));
  }
  return Report(violations);
}

std::string MarkdownTable(const std::vector<FieldRef>& fields) {
  std::string table = "| parameter | default | range | unit | what it does |\n| --- | --- | --- | --- | --- |\n";
  for (const FieldRef& field : fields) {
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", field.name, ValueToJson(field).dump(), RangeText(field.spec),
                         field.spec.unit, field.spec.reason);
  }
  return table;
}

}  // namespace victorious
