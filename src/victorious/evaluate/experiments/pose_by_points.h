// How a known thing stands before a camera, from points of it that a person marked in a picture.
#pragma once

#include <optional>
#include <span>

#include "victorious/geolocate/object_pose.h"

namespace victorious {

/// From all sides, the pose in which the points fit best.
/// @param sigma  of a mark at depth 1, along each axis
/// Nothing for fewer than three points, or where they fit from no side.
[[nodiscard]] std::optional<ObjectPose> PoseByPoints(std::span<const SeenPoint> points, double sigma);

}  // namespace victorious
