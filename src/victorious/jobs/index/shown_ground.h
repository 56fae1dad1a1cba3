// The ground that a camera may have shown, whatever its height is: boxes that are stored with the video. A query finds
// by them the few videos whose camera paths are worth reading for a place.
#pragma once

#include <span>
#include <vector>

#include "victorious/types/camera_state.h"
#include "victorious/types/sighting_filter.h"

namespace victorious {

/// At most this many boxes are made of a video.
inline constexpr std::size_t kMaxShownGroundBoxes = 64;

/// Boxes of equal numbers of states, in their order. Each holds what the frames of its states show of flat ground at
/// any height above -500 m (ellipsoid), as far as 20 km from the camera. A state without attitude, field of view or
/// ellipsoidal height, and one with a corner at or above the horizon, shows nothing (as apps/serve/camera_path.h has
/// it).
[[nodiscard]] std::vector<GeoBox> ShownGround(std::span<const CameraState> states, int width_px, int height_px);

}  // namespace victorious
