// Converts an object pose into a landmark sighting with its information matrix, for landmark navigation (navigate/).
#pragma once

#include <optional>

#include "victorious/place/navigate/landmark.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {

/// Lower bounds of the rotation error. The errors of matched points are correlated, and of few points some are matched
/// to a view from another side, so the covariance of the pose fit is too small. The added error is a rotation about the
/// centroid of the points, so it shifts the object's centre, too.
/// Not user parameters: measured on landmarks matched by 9 to 14 points, which were rotated by up to 20 degrees, and by
/// 50 and more, rotated by a degree (ADR 0011).
struct LandmarkSightingOptions {
  double min_rotation_sigma_deg = 1;  ///< minimum standard deviation of a landmark's rotation in one frame
  /// Adds the square of this over the number of matched points, in degrees, to that standard deviation: up to a third
  /// of this number of points may be matched to a wrong view, three times this number never are.
  double reference_points = 30;
};

/// Returns a sighting with its pose and information matrix; the caller sets `frame` and `model`. std::nullopt if the
/// object pose has no range, or its covariance is singular. Without a 6-DoF pose the sighting constrains the position
/// only.
/// @param observation  standard deviations of points, direction and range
std::optional<LandmarkSighting> MakeLandmarkSighting(const ObjectPose& object_pose,
                                                     const ObservationOptions& observation,
                                                     const LandmarkSightingOptions& options);

}  // namespace victorious
