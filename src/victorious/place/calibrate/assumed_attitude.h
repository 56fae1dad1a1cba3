// Attitudes of a camera without telemetry, for the search conditions of its frames only: an assumed tilt, and the yaw
// that the image shows. They suffice to search for upright objects with templates relit for the sun's direction
// (sun_direction.h); nothing gets a place by them.
//
// A camera without roll that turns about the vertical turns the image about its optical axis by
//
//   d shift_y / d x = - yaw' cos(off_nadir)
//
// whatever its translation and the height of the ground: level ground has the same depth along a row of the image.
#pragma once

#include <vector>

#include "victorious/place/calibrate/time_offset.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// One state at each time of `seen`, without a place; yaw 0 at the first. Empty if the motion of more than one pair of
/// frames in ten is unknown: the video is cut, or blank. The yaw drifts by some per cent of the angle that the camera
/// turns by; the tilt may not change by more than 20 degrees.
/// @param off_nadir_rad  of the optical axis, [0, pi/2)
[[nodiscard]] std::vector<CameraState> AssumeAttitudes(const ImageMotions& seen, double off_nadir_rad);

}  // namespace victorious
