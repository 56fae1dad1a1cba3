// Private to telemetry/: converts heights above mean sea level or the take-off to heights above the ellipsoid.
#pragma once

#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/input/telemetry/telemetry.h"

namespace victorious {

/// Converts the heights for which the options or an installed geoid grid suffice. The others keep their datum, with one
/// warning per datum.
/// Errors: those of Geoid::Read for a grid that cannot be read.
[[nodiscard]] Status ConvertToEllipsoid(std::vector<CameraState>& states, const TelemetryOptions& options,
                                        std::vector<std::string>& warnings);

}  // namespace victorious
