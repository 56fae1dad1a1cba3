// The camera's state as telemetry.csv has it: a header, then a row a frame.
#pragma once

#include <string>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {

/// Where a camera is on Earth and how it is held against true north and the vertical there.
struct CameraOnEarth {
  GeodeticPoint place;
  Attitude attitude;
};

/// @param earth             its origin is the town's
/// @param town_heading_rad  where the town's y axis points there, clockwise from north
[[nodiscard]] CameraOnEarth CameraOnEarthOf(const Rigid3& camera_from_town, const TangentPlane& earth,
                                            double town_heading_rad);

inline constexpr const char* kTelemetryHeader =
    "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";

/// With its end of line.
[[nodiscard]] std::string TelemetryRow(const CameraOnEarth& camera, double time_s, double hfov_deg);

}  // namespace victorious
