// Estimates the 6-DoF pose of a known object from manually marked image points (PnP).
#pragma once

#include <optional>
#include <span>

#include "victorious/place/geolocate/object_pose.h"

namespace victorious {

/// Fits the pose from initial directions all over the sphere (every 20 degrees, off-nadir angles up to 80) with
/// FitObjectPose, and returns the one with the minimum sum of squared residuals.
/// @param points  in the object's frame, with their normalised image coordinates
/// @param sigma   standard deviation of a mark along each axis, in normalised image coordinates
/// Returns std::nullopt for fewer than three points, or if no fit converges.
[[nodiscard]] std::optional<ObjectPoseFit> FitPoseToPoints(std::span<const PointObservation> points, double sigma);

}  // namespace victorious
