// The camera's state in a frame, as telemetry.csv has it (telemetry/camera_csv.h).
#pragma once

#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// Where a camera is on Earth and how it is held against true north and the vertical there.
/// @param earth             its origin is the town's
/// @param town_heading_rad  where the town's y axis points there, clockwise from north
[[nodiscard]] CameraState CameraStateOf(const Rigid3& camera_from_town, const TangentPlane& earth,
                                        double town_heading_rad, double time_s, double hfov_rad);

}  // namespace victorious
