// Private to telemetry/: heights above the sea or the take-off, as heights above the ellipsoid.
#pragma once

#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/telemetry/telemetry.h"

namespace victorious {

/// Turns what the options and the machine's geoid grids allow to turn; the rest keeps its datum, with one line a datum.
/// Errors: kInvalidArgument and kNotFound for a grid that the user names and that cannot be read.
Status BringToEllipsoid(std::vector<CameraState>& states, const TelemetryOptions& options,
                        std::vector<std::string>& warnings);

}  // namespace victorious
