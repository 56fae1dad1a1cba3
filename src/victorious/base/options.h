// Field lists of options structs. One list per struct serves validation, JSON, `--params` and the manual, so that no
// parameter is declared twice.
//
//   struct MatchOptions {
//     double ratio = 0.8;
//     void ListFields(FieldList& fields) {
//       fields.Add("ratio", ratio, {.min = 0.1, .max = 1.0, .unit = "", .reason = "Lowe's ratio test ..."});
//     }
//   };
//
// Structs nest by `fields.AddGroup("match", match)`; a field's full name is then "match.ratio".
// A std::optional<double> is a number that may be absent: null in JSON.
// A field that is an enum is listed with the table of its texts (enum_text.h), which are its choices and its JSON:
// `fields.Add("filter", filter, kFilterTexts, {.reason = "..."})`.
//
// Every field of an options struct is one of two kinds:
//   - a user parameter: listed. The list gives unit, range and reason, and so docs/parameters.md; the header repeats
//     them only briefly, or not at all.
//   - not listed: set by the caller, the presets, the experiments or the tests. Its comment gives unit and reason and
//     ends with "Not a user parameter"; a comment "Not user parameters" covers a struct, "Not user parameters from here
//     on" the rest of one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/base/check.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"

namespace victorious {

/// The meaning of a field and its allowed values.
struct FieldSpec {
  double min = -std::numeric_limits<double>::infinity();  ///< smallest value, inclusive
  double max = std::numeric_limits<double>::infinity();   ///< largest value, inclusive
  std::vector<std::string> choices = {};                  ///< for text and enums: the allowed values; empty: any
  std::string unit = {};                                  ///< "px", "s", …; empty if dimensionless
  std::string reason = {};                                ///< the effect of the field and the reason for its default
};

/// A reference to an enum field of any type, read and written as text.
struct EnumFieldRef {
  std::function<std::string_view()> text;          ///< the value's text; empty for a value that the table does not have
  std::function<void(std::string_view)> set_text;  ///< @param text  one of FieldSpec::choices
};

/// A reference to a field of an options struct: full name, value and spec. Valid during the lifetime of that struct.
struct FieldRef {
  std::string name;
  std::variant<double*, int*, bool*, std::uint64_t*, std::string*, std::optional<double>*, EnumFieldRef> value;
  FieldSpec spec;
};

/// The fields of an options struct, groups flattened into dotted names.
class FieldList {
 public:
  FieldList();
  ~FieldList();
  FieldList(const FieldList&) = delete;
  FieldList& operator=(const FieldList&) = delete;

  void Add(std::string_view name, double& value, FieldSpec spec);
  void Add(std::string_view name, int& value, FieldSpec spec);
  void Add(std::string_view name, bool& value, FieldSpec spec);
  void Add(std::string_view name, std::uint64_t& value, FieldSpec spec);
  void Add(std::string_view name, std::string& value, FieldSpec spec);
  void Add(std::string_view name, std::optional<double>& value, FieldSpec spec);

  /// A field that is an enum.
  /// @param texts  of all values, in the order in which the manual lists them. Static: the field refers to it.
  /// @param spec   without `choices`: they are the texts
  template <typename Enum, std::size_t count>
  void Add(std::string_view name, Enum& value, const std::array<EnumText<Enum>, count>& texts, FieldSpec spec) {
    VICTORIOUS_CHECK(spec.choices.empty());
    for (const EnumText<Enum>& entry : texts) spec.choices.emplace_back(entry.text);
    AddEnum(name,
            {.text = [&value, &texts] { return ToText(texts, value); },
             .set_text = [&value, &texts](std::string_view text) { value = FromText(texts, text).value(); }},
            std::move(spec));
  }

  template <typename Options>
  void AddGroup(std::string_view name, Options& options) {
    const std::string outer = EnterGroup(name);
    options.ListFields(*this);
    prefix_ = outer;
  }

  [[nodiscard]] const std::vector<FieldRef>& fields() const { return fields_; }

 private:
  void AddEnum(std::string_view name, EnumFieldRef value, FieldSpec spec);
  std::string EnterGroup(std::string_view name);  // returns the prefix outside it

  std::string prefix_;
  std::vector<FieldRef> fields_;
};

/// Returns the fields of `options`; they point into it.
template <typename Options>
std::vector<FieldRef> CollectFields(Options& options) {
  FieldList list;
  options.ListFields(list);
  return list.fields();
}

/// Returns the values as nested JSON: {"match": {"ratio": 0.8}, …}.
nlohmann::json ToJson(const std::vector<FieldRef>& fields);

/// Sets the fields named in `json`, nested or dotted ("match.ratio"). Error: kInvalidArgument with all unknown names,
/// wrong types and values out of range in one line; then no field is changed.
[[nodiscard]] Status SetFromJson(const nlohmann::json& json, const std::vector<FieldRef>& fields);

/// As SetFromJson, of stored text. Error: kInvalidArgument with "not JSON" too.
[[nodiscard]] Status SetFromJsonText(std::string_view text, const std::vector<FieldRef>& fields);

/// Checks all constraints. Error: kInvalidArgument with every violated constraint as "field = value: constraint", in
/// one line.
[[nodiscard]] Status Validate(const std::vector<FieldRef>& fields);

/// Returns a Markdown table with one row per field (name, default, range, unit, reason).
std::string MarkdownTable(const std::vector<FieldRef>& fields);

/// Returns ToJson as text with sorted keys: equal options give equal text.
std::string ToJsonText(const std::vector<FieldRef>& fields);

template <typename Options>
std::string OptionsToJsonText(Options options) {
  FieldList list;
  options.ListFields(list);
  return ToJsonText(list.fields());
}

template <typename Options>
[[nodiscard]] Status ValidateOptions(Options options) {
  FieldList list;
  options.ListFields(list);
  return Validate(list.fields());
}

}  // namespace victorious
