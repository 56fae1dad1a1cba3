#include "victorious/base/json.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace victorious {

using nlohmann::json;
using nlohmann::ordered_json;

Expected<json> ParseJson(std::string_view text) {
  std::vector<std::set<std::string>> keys;  // of the open objects, innermost last
  std::string twice;
  const json::parser_callback_t watch = [&](int /*depth*/, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second && twice.empty()) {
      twice = DumpJson(parsed);
    }
    return true;
  };
  json document = json::parse(text, watch, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  if (document.is_discarded()) return Fail(ErrorCode::kInvalidArgument, "not JSON");
  if (!twice.empty()) return Fail(ErrorCode::kInvalidArgument, twice + ": given twice");
  return document;
}

Expected<json> ParseStrictJson(std::string_view text) {
  json document = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (document.is_discarded()) return Fail(ErrorCode::kInvalidArgument, "not JSON");
  return document;
}

std::string DumpJson(const json& value, int indent) {
  return value.dump(indent, ' ', false, json::error_handler_t::replace);
}

std::string DumpJson(const ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

std::string ReplaceInvalidUtf8(std::string_view text) { return json::parse(DumpJson(json(text))).get<std::string>(); }

}  // namespace victorious
