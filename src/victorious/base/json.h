// JSON text: reading and writing, compiled once. Sources that only handle values include nlohmann/json.hpp beside it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "victorious/base/error.h"

namespace victorious {

/// Parses JSON written by people: accepts comments, rejects duplicate keys. Safe for any bytes.
/// Error: kInvalidArgument with "not JSON", or with the first duplicate key.
[[nodiscard]] Expected<nlohmann::json> ParseJson(std::string_view text);

/// Parses JSON written by programs: no comments; of a duplicate key the last value counts. Safe for any bytes.
/// Error: kInvalidArgument with "not JSON".
[[nodiscard]] Expected<nlohmann::json> ParseStrictJson(std::string_view text);

/// JSON as text; replaces bytes that are not UTF-8.
/// @param indent  spaces a level; -1: one line
std::string DumpJson(const nlohmann::json& value, int indent = -1);
std::string DumpJson(const nlohmann::ordered_json& value, int indent = -1);

/// The text as JSON can hold it: bytes that are not UTF-8 become U+FFFD.
std::string ReplaceInvalidUtf8(std::string_view text);

/// The value, or null for std::nullopt. Result is complete where it is called: this header only declares it.
template <typename Value, typename Result = nlohmann::ordered_json>
Result OrNull(const std::optional<Value>& value) {
  return value ? Result(*value) : Result();
}
/// The converted value, or null for std::nullopt.
template <typename Value, typename Result>
Result OrNull(const std::optional<Value>& value, Result (*convert)(Value)) {
  return value ? convert(*value) : Result();
}

}  // namespace victorious
