#include "victorious/base/without_folders.h"

#include <algorithm>
#include <string_view>

namespace victorious {

std::string WithoutFolders(const std::string& text) {
  constexpr std::string_view kBefore = " \t\n\"'`([{=:,;<>|";
  constexpr std::string_view kEnds = ":\"'`()[]{}<>|,;\\\n\t";
  constexpr std::string_view kApi = "/api/";
  const std::string_view all = text;
  std::string shown;
  for (std::size_t i = 0; i < all.size();) {
    const bool follows = i == 0 || kBefore.find(all[i - 1]) != std::string_view::npos;
    const bool is_address = all.substr(i).starts_with("//") || all.substr(i).starts_with(kApi);
    const bool has_name = i + 1 < all.size() && all[i + 1] != ' ' && kEnds.find(all[i + 1]) == std::string_view::npos;
    if (all[i] != '/' || !follows || is_address || !has_name) {
      shown += all[i++];
      continue;
    }
    const std::size_t end = std::min(all.find_first_of(kEnds, i), all.size());
    std::string_view path = all.substr(i, end - i);
    while (path.size() > 1 && path.ends_with('/')) path.remove_suffix(1);
    shown += path.substr(path.rfind('/') + 1);
    i = end;
  }
  return shown;
}

}  // namespace victorious
