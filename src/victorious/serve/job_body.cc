#include "victorious/serve/job_body.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace victorious {

ApiStatus CheckMembers(const nlohmann::json& body, std::initializer_list<std::string_view> names) {
  for (const auto& [name, value] : body.items()) {
    if (std::ranges::find(names, name) == names.end()) return FailField(name, name + ": not a member of such a job");
  }
  return {};
}

}  // namespace victorious
