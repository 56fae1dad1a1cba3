// Estimates the height of the ground that a video shows, from the motion of the image: the nearer the ground, the
// faster it moves through the image of a camera that moves.
//
//   measured motion = f(camera before, camera after, 1 / depth) + noise
//
// as in time_offset.h, with telemetry's clock, field of view and attitudes as they are, and without a bias: that of a
// steady flight would be the motion itself. Measured and predicted motions are averaged over each second, where noise
// of attitudes cancels but for the first and the last. The depth below the median camera height minimises a Huber loss.
//
// Limits. The ground is flat and level, and is what most of the image shows: roofs and trees all over it raise the
// estimate. An error of the field of view, or of the speed of the camera, is one of the depth, of the same ratio. A
// turn that telemetry lacks counts as motion, most for a camera that is slow and high. On the drawn flights of this
// project the depth was within 1 %.
#pragma once

#include <optional>

#include "victorious/input/telemetry/camera_track.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {

/// Flat ground, over the part of the video that was measured.
struct GroundHeight {
  double height_m = 0;  ///< above `datum`
  double sigma_m = 0;   ///< standard error, with 1 % of the depth for what stands on the ground
  VerticalDatum datum = VerticalDatum::kEllipsoid;  ///< that of the camera states

  bool operator==(const GroundHeight&) const = default;
};

/// std::nullopt if less than four seconds are seen, if the camera hardly moves, if telemetry lacks attitudes, fields of
/// view or heights, if its places are too noisy for the speed, or if it does not explain the motion: then the standard
/// error is above 15 % of the depth. Deterministic. Cost: some 10 ms for 20 s of video at ten pairs a second.
/// @param cameras  telemetry's states, on the video's clock
[[nodiscard]] std::optional<GroundHeight> EstimateGroundHeight(const ImageMotions& seen,
                                                               const CameraTrajectory& cameras);

}  // namespace victorious
