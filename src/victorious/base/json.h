// A parser for JSON written by people: accepts comments, rejects duplicate keys.
#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "victorious/base/error.h"

namespace victorious {

/// Safe for any bytes. Error: kInvalidArgument with "not JSON", or with the first duplicate key.
[[nodiscard]] Expected<nlohmann::json> ParseJson(std::string_view text);

}  // namespace victorious
