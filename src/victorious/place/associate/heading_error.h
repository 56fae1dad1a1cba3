// The error of a flight's yaw, as by a compass. Lines of sight from a camera that circles an object meet in one point;
// if every yaw is off by the same angle d, they are tangents of a circle around the object instead, with the radius
// distance * sin d:
//
//   d = argmin_d min_o sum_i rho(|distance of o from line i turned by -d about the vertical|^2 / s_i^2)
//
// per object, with Huber's rho. If several different objects agree on one angle, and more than agree with none, the
// common cause is the yaw. Vehicles that drive steadily in one direction agree on an angle, too, past a camera that
// flies straight: an object whose lines a steady motion explains as well as an angle determines none.
#pragma once

#include <optional>
#include <span>

#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

struct HeadingError {
  double error_rad = 0;  ///< yaw of the telemetry less the true one
  int objects = 0;       ///< tracklets that agree on it
};

/// Estimates the error of one flight; std::nullopt without a common error of at least 1.5 degrees, or above 20 degrees,
/// which is that of another flight's telemetry. Ranges are not used, so that a wrong field of view does not matter.
/// @param tracklets  of one video
/// Cost: some 17 fits of a point to at most 60 lines for each tracklet whose lines turn by 25 degrees.
std::optional<HeadingError> EstimateHeadingError(std::span<const ObservedTracklet> tracklets);

/// Turns lines of sight and headings of the tracklets back by the error.
void TurnBack(const HeadingError& error, std::span<ObservedTracklet> tracklets);

}  // namespace victorious
