// What is known of the offset of telemetry's clock before the motion of the image is compared (time_offset.h), and all
// that is known where that tells nothing:
//
// Past a camera that flies straight, at constant speed and attitude, an offset of the clock moves the camera of every
// frame by the same vector. Lines of sight, ranges by known sizes, views and the horizon, which are all relative to the
// camera, stay in agreement with each other whatever the offset. Nothing within such a flight contradicts it.
//
// What is left is how the telemetry was recorded. One that begins and ends with the video was recorded with it, and is
// off by frames. One that is as long as the video, but begins and ends later, was recorded with it, too, and stamped by
// another clock. Any other, such as the log of a whole flight, was recorded apart, and may be seconds off.
#pragma once

#include <optional>
#include <span>

#include "victorious/input/telemetry/telemetry.h"
#include "victorious/types/camera_state.h"

namespace victorious {

enum class TelemetryExtent {
  kOfVideo,    ///< begins and ends with the video
  kDisplaced,  ///< is as long as the video, and begins and ends earlier or later
  kOther,      ///< begins or ends elsewhere
};

struct ClockPrior {
  TelemetryExtent extent = TelemetryExtent::kOfVideo;
  double offset_s = 0;  ///< to be added to telemetry's times, s; 0 unless kDisplaced
  double sigma_s = 0;   ///< standard deviation of the offset, s; 0: the clock is exact
};

/// @param states      in order of time
/// @param duration_s  of the video; std::nullopt: unknown, then only the beginnings are compared
[[nodiscard]] ClockPrior MakeClockPrior(std::span<const CameraState> states, std::optional<double> duration_s,
                                        const TelemetryOptions& options);

}  // namespace victorious
