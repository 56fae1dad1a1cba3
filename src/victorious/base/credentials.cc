#include "victorious/base/credentials.h"

#include <algorithm>
#include <string_view>

namespace victorious {
namespace {

constexpr std::string_view kDatabaseScheme = "postgresql";

}  // namespace

std::string WithoutCredentials(std::string text) {
  constexpr std::string_view kMark = "://";
  for (std::size_t mark = text.find(kMark); mark != std::string::npos; mark = text.find(kMark, mark + 1)) {
    if (std::string_view(text).substr(0, mark).ends_with(kDatabaseScheme)) continue;
    const std::size_t host = mark + kMark.size();
    const std::size_t end = std::min(text.find_first_of("/?# \t\"'", host), text.size());
    const std::size_t at = std::string_view(text).substr(host, end - host).rfind('@');
    if (at != std::string_view::npos) text.erase(host, at + 1);
    // Some cameras take the password in the query.
    const std::size_t rest = std::min(text.find_first_of(" \t\"'", host), text.size());
    const std::size_t query = std::string_view(text).substr(host, rest - host).find('?');
    if (query != std::string_view::npos) text.replace(host + query, rest - host - query, "?…");
  }
  return text;
}

}  // namespace victorious
