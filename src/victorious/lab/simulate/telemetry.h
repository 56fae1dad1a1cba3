// The ground-truth camera state of a frame, as written to telemetry.csv (input/telemetry/camera_csv.h).
#pragma once

#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// Geodetic position of the camera (WGS 84) and its attitude relative to true north and the vertical there.
/// @param earth             tangent plane at the origin of the town
/// @param town_heading_rad  heading of the town's y axis at the origin, clockwise from north
[[nodiscard]] CameraState MakeCameraState(const Rigid3& camera_from_town, const TangentPlane& earth,
                                          double town_heading_rad, double time_s, double hfov_rad);

}  // namespace victorious
