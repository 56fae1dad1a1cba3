#include "victorious/serve/live_address.h"

#include <algorithm>
#include <string_view>

namespace victorious {

std::string WithoutCredentials(std::string text) {
  constexpr std::string_view kMark = "://";
  for (std::size_t mark = text.find(kMark); mark != std::string::npos; mark = text.find(kMark, mark + 1)) {
    const std::size_t host = mark + kMark.size();
    const std::size_t end = std::min(text.find_first_of("/?# \t\"'", host), text.size());
    const std::size_t at = std::string_view(text).substr(host, end - host).rfind('@');
    if (at != std::string_view::npos) text.erase(host, at + 1);
  }
  return text;
}

}  // namespace victorious
