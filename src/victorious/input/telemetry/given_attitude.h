// Private to telemetry/: the attitude of a camera whose telemetry gives positions but no gimbal angles, from what the
// pilot knows: its pitch, and its yaw or that it looked in the direction of flight.
#pragma once

#include <string>
#include <vector>

#include "victorious/input/telemetry/telemetry.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// Sets the attitude of the states without one from `camera_pitch_deg` and `camera_yaw_deg` of the options, level (roll
/// 0), with a standard deviation of 2 degrees. Without a yaw, the camera looks along the course over ground, with 10
/// degrees: an aircraft crabs in the wind. Does nothing without `camera_pitch_deg`.
/// @param states  in order of time
/// Adds one warning if states stay without attitude, because the camera never moves.
void CompleteAttitudes(std::vector<CameraState>& states, const TelemetryOptions& options,
                       std::vector<std::string>& warnings);

}  // namespace victorious
