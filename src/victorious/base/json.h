// JSON that people write: comments are let through, a key that is given twice is not.
#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "victorious/base/error.h"

namespace victorious {

/// Any bytes are safe. Errors: kInvalidArgument, "not JSON", or the first key that an object has twice.
Expected<nlohmann::json> ParseJson(std::string_view text);

}  // namespace victorious
