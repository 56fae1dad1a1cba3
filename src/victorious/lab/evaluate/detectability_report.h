// The result of MeasureDetectability() as JSON and as text with advice.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "victorious/lab/evaluate/detectability.h"

namespace victorious {

nlohmann::ordered_json ToJson(const Detectability& findable);

/// Returns a table of the bands as text, followed by advice in sentences.
std::string ToText(const Detectability& findable);

}  // namespace victorious
