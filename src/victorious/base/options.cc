#include "victorious/base/options.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/suggestion.h"

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
  return std::visit(Overloaded{[](const auto* value) { return json(*value); },
                               [](const std::optional<double>* value) { return *value ? json(**value) : json(); },
                               [](const EnumFieldRef& value) { return json(value.text()); }},
                    field.value);
}

std::string RangeText(const FieldSpec& spec) {
  if (!spec.choices.empty()) return fmt::format("one of {}", fmt::join(spec.choices, ", "));
  const bool low = std::isfinite(spec.min);
  const bool high = std::isfinite(spec.max);
  if (low && high) return fmt::format("{} to {}", spec.min, spec.max);
  if (low) return fmt::format("at least {}", spec.min);
  if (high) return fmt::format("at most {}", spec.max);
  return "any";
}

std::string_view TypeText(const FieldRef& field) {
  return std::visit(Overloaded{[](const double*) { return "a number"; }, [](const int*) { return "a whole number"; },
                               [](const bool*) { return "true or false"; },
                               [](const std::uint64_t*) { return "a whole number, at least 0"; },
                               [](const std::string*) { return "text"; },
                               [](const std::optional<double>*) { return "a number, or null for none"; },
                               [](const EnumFieldRef&) { return "text"; }},
                    field.value);
}

std::string ValueText(const json& value) {
  if (value.is_structured()) return fmt::format("an {}", value.type_name());
  if (value.is_number_float()) {
    // JSON cannot represent NaN and infinities.
    if (const double number = value.get<double>(); !std::isfinite(number)) return fmt::format("{}", number);
  }
  return DumpJson(value);
}

bool TypeFits(const FieldRef& field, const json& value) {
  // nlohmann::json compares signed and unsigned numbers bitwise. Compared as doubles, a large number does not equal a
  // negative one.
  const double number = value.is_number() ? value.get<double>() : 0.0;
  return std::visit(Overloaded{[&](const double*) { return value.is_number() && std::isfinite(number); },
                               [&](const std::optional<double>*) {
                                 return value.is_null() || (value.is_number() && std::isfinite(number));
                               },
                               [&](const int*) {
                                 return value.is_number_integer() && number >= std::numeric_limits<int>::min() &&
                                        number <= std::numeric_limits<int>::max();
                               },
                               [&](const bool*) { return value.is_boolean(); },
                               [&](const std::uint64_t*) { return value.is_number_integer() && number >= 0; },
                               [&](const std::string*) { return value.is_string(); },
                               [&](const EnumFieldRef&) { return value.is_string(); }},
                    field.value);
}

bool InRange(const FieldSpec& spec, const json& value) {
  if (value.is_number()) {
    const double number = value.get<double>();
    return number >= spec.min && number <= spec.max;
  }
  if (value.is_string() && !spec.choices.empty()) {
    return std::ranges::find(spec.choices, value.get_ref<const std::string&>()) != spec.choices.end();
  }
  return true;
}

// Returns a message with the constraint that `value` violates, or empty.
std::string Violation(const FieldRef& field, const json& value) {
  const bool type_fits = TypeFits(field, value);
  if (type_fits && InRange(field.spec, value)) return {};
  return fmt::format("{} = {}: must be {}", field.name, ValueText(value),
                     type_fits ? RangeText(field.spec) : TypeText(field));
}

// The edit distance of `name` to a field's full name, or to its last part if that is smaller.
std::size_t NameDistance(std::string_view name, std::string_view field_name) {
  const std::string_view last_part = field_name.substr(field_name.rfind('.') + 1);
  return std::min(EditDistance(name, field_name), EditDistance(name, last_part));
}

std::string UnknownName(const std::string& name, const std::vector<FieldRef>& fields) {
  const auto nearest =
      std::ranges::min_element(fields, {}, [&](const FieldRef& field) { return NameDistance(name, field.name); });
  const std::string unknown = DumpJson(json(name)) + ": unknown parameter";
  const bool is_near = nearest != fields.end() && NameDistance(name, nearest->name) <= MaxTypingEdits(name);
  return is_near ? fmt::format("{}; the nearest is {}", unknown, nearest->name) : unknown;
}

bool IsGroup(const std::string& name, const std::vector<FieldRef>& fields) {
  return std::ranges::any_of(fields, [&](const FieldRef& field) { return field.name.starts_with(name + "."); });
}

using NamedValues = std::vector<std::pair<std::string, const json*>>;

// Flattens {"match": {"ratio": 0.8}} and {"match.ratio": 0.8} alike. Descends only into groups that exist, so that the
// options, not the input, bound the recursion depth.
void Flatten(const json& node, const std::string& prefix, const std::vector<FieldRef>& fields, NamedValues& out) {
  for (const auto& [key, value] : node.items()) {
    const std::string name = prefix + key;
    if (value.is_object() && IsGroup(name, fields)) {
      Flatten(value, name + ".", fields, out);
    } else {
      out.emplace_back(name, &value);
    }
  }
}

void Assign(const FieldRef& field, const json& value) {
  std::visit(Overloaded{[&]<typename T>(T* target) { *target = value.get<T>(); },
                        [&](std::optional<double>* target) {
                          *target = value.is_null() ? std::nullopt : std::optional(value.get<double>());
                        },
                        [&](const EnumFieldRef& target) { target.set_text(value.get_ref<const std::string&>()); }},
             field.value);
}

Status Report(const std::vector<std::string>& violations) {
  if (violations.empty()) return {};
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}", fmt::join(violations, "; ")));
}

}  // namespace

FieldList::FieldList() = default;
FieldList::~FieldList() = default;

void FieldList::Add(std::string_view name, double& value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), &value, std::move(spec)});
}
void FieldList::Add(std::string_view name, int& value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), &value, std::move(spec)});
}
void FieldList::Add(std::string_view name, bool& value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), &value, std::move(spec)});
}
void FieldList::Add(std::string_view name, std::uint64_t& value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), &value, std::move(spec)});
}
void FieldList::Add(std::string_view name, std::string& value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), &value, std::move(spec)});
}
void FieldList::Add(std::string_view name, std::optional<double>& value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), &value, std::move(spec)});
}

void FieldList::AddEnum(std::string_view name, EnumFieldRef value, FieldSpec spec) {
  fields_.push_back({prefix_ + std::string(name), std::move(value), std::move(spec)});
}

std::string FieldList::EnterGroup(std::string_view name) {
  return std::exchange(prefix_, prefix_ + std::string(name) + ".");
}

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

std::string ToJsonText(const std::vector<FieldRef>& fields) { return DumpJson(ToJson(fields)); }

Status SetFromJson(const nlohmann::json& values, const std::vector<FieldRef>& fields) {
  if (!values.is_object()) {
    return Fail(ErrorCode::kInvalidArgument, "parameters must be a JSON object of names and values");
  }
  NamedValues flat;
  Flatten(values, "", fields, flat);
  std::vector<std::string> violations;
  std::set<std::string_view> seen;
  for (const auto& [name, value] : flat) {
    const auto field = std::ranges::find(fields, name, &FieldRef::name);
    if (field == fields.end()) {
      violations.push_back(UnknownName(name, fields));
    } else if (!seen.insert(name).second) {
      violations.push_back(name + ": given twice");
    } else if (std::string violation = Violation(*field, *value); !violation.empty()) {
      violations.push_back(std::move(violation));
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(Report(violations));
  for (const auto& [name, value] : flat) Assign(*std::ranges::find(fields, name, &FieldRef::name), *value);
  return {};
}

Status SetFromJsonText(std::string_view text, const std::vector<FieldRef>& fields) {
  VICTORIOUS_ASSIGN_OR_RETURN(const json values, ParseStrictJson(text));
  return SetFromJson(values, fields);
}

Status Validate(const std::vector<FieldRef>& fields) {
  std::vector<std::string> violations;
  for (const FieldRef& field : fields) {
    if (std::string violation = Violation(field, ValueToJson(field)); !violation.empty()) {
      violations.push_back(std::move(violation));
    }
  }
  return Report(violations);
}

std::string MarkdownTable(const std::vector<FieldRef>& fields) {
  std::string table = "| parameter | default | range | unit | what it does |\n| --- | --- | --- | --- | --- |\n";
  for (const FieldRef& field : fields) {
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", field.name, DumpJson(ValueToJson(field)),
                         RangeText(field.spec), field.spec.unit, field.spec.reason);
  }
  return table;
}

}  // namespace victorious
