// What the bodies of all requests for jobs have in common.
#pragma once

#include <initializer_list>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "victorious/serve/api_error.h"

namespace victorious {

/// Checks that a body has no members but these. Error: kInvalidArgument with the member's name as its field.
[[nodiscard]] ApiStatus CheckMembers(const nlohmann::json& body, std::initializer_list<std::string_view> names);

}  // namespace victorious
