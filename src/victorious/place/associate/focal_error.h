// The error of a flight's focal length (field of view), as the views of its objects contradict it.
//
// The line of sight to an object turns while the camera passes, and the object is seen from directions that turn by the
// same angle. Its view is measured from its image alone, and hardly depends on the focal length f; its line of sight
// does, the more the farther it is off the optical axis. For each object, of the logarithm k of the true over the given
// focal length,
//
//   k = argmin_k min_R sum_i |v_i - R u_i(k)|^2 / s_i^2
//
// with the direction of view v_i in axes fixed to the object, its standard deviation s_i, the direction u_i to the
// camera by the line of sight (LineOfSight::focal_shift gives its change with k), and a rotation R. This holds for
// objects that stand or do not turn; those that turn are outliers among the others. It determines k past a camera that
// flies straight, where ranges and lines of sight do not. The slope of the ground does not matter, as it does for the
// motion of the image (place/calibrate/field_of_view.h), whose estimate is the prior.
//
// The prior is one of two normal distributions about zero, as before any measurement (input/telemetry/focal_prior.h):
// the field of view is right, or wrong with a probability that gives both together the standard deviation of
// focal_shift. Many that are right are exact. The scale t of their errors is therefore estimated, too, from the
// measurement k with the standard deviation s: t^2 = max(0, k^2 - 4 s^2), at most that of the prior. An error of the
// views thus shifts no place, unless they show twice as much.
#pragma once

#include <optional>
#include <span>

#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

struct FocalError {
  double log_factor = 0;   ///< of the true over the given focal length
  double sigma_ratio = 1;  ///< standard deviation of what is left of the error over that of focal_shift
  int objects = 0;         ///< tracklets that determine it
};

/// Estimates the error of one flight. std::nullopt if fewer than three objects determine it, or its standard deviation
/// is not given. Some 20 us a sighting.
/// @param tracklets  of one video
[[nodiscard]] std::optional<FocalError> EstimateFocalError(std::span<const ObservedTracklet> tracklets);

/// Corrects lines of sight and ranges, and scales what is left of the error.
void CorrectFocalLength(const FocalError& error, std::span<ObservedTracklet> tracklets);

}  // namespace victorious
