// Private to calibrate/: the noise of telemetry from one state to the next.
#pragma once

#include "victorious/input/telemetry/camera_track.h"

namespace victorious {

/// Standard deviations, per axis, of the noise of telemetry from one state to the next: of the differences between each
/// state and those beside it, of which a smooth flight leaves almost nothing.
struct TelemetryNoise {
  double attitude_rad = 0;
  double place_m = 0;
};

/// All 0 without three states that have attitudes. There is at least one state.
[[nodiscard]] TelemetryNoise EstimateNoise(const CameraTrajectory& cameras);

}  // namespace victorious
