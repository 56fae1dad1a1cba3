#include "victorious/base/file_head.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "victorious/base/json.h"

namespace victorious {

std::string_view FirstLine(std::string_view head) { return head.substr(0, head.find_first_of("\r\n")); }

bool IsJsonLine(std::string_view head, std::initializer_list<const char*> members) {
  const Expected<nlohmann::json> json = ParseStrictJson(FirstLine(head));
  return json && json->is_object() &&
         std::ranges::all_of(members, [&](const char* name) { return json->contains(name); });
}

bool IsJsonWith(std::string_view head, std::initializer_list<std::string_view> texts) {
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && head[start] == '{' &&
         std::ranges::all_of(texts, [&](std::string_view text) { return head.contains(text); });
}

bool IsTextOf(std::string_view text, std::string_view allowed) {
  return !text.empty() && text.find_first_not_of(allowed) == std::string_view::npos;
}

}  // namespace victorious
