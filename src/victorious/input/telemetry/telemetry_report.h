// telemetry/: the content of a Telemetry as JSON, and as a summary for people.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/input/telemetry/telemetry.h"

namespace victorious {

/// Every item of every KLV packet by number and name, checksums and time stamps; the states; the warnings.
nlohmann::json ToJson(const Telemetry& telemetry);

/// A summary for people, in lines: the content, and what is missing for geolocation.
[[nodiscard]] std::vector<std::string> DescribeTelemetry(const Telemetry& telemetry);

}  // namespace victorious
