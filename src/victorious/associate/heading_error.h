// The error of a flight's yaw, as by a compass. Lines of sight from a camera that circles an object meet in one point;
// if every yaw is off by the same angle d, they are tangents of a circle around the object instead, with the radius
// distance * sin d:
//
//   d = argmin_d min_o sum_i rho(|distance of o from line i turned by -d about the vertical|^2 / s_i^2)
//
// per object, with Huber's rho. If several different objects agree on one angle, and more than agree with none, the common
// cause is the yaw. Vehicles that drive steadily in one direction agree on an angle, too, past a camera that flies
// straight: an object whose lines a steady motion explains as well as an angle determines none.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "victorious/associate/associate_objects.h"
#include "victorious/store/index_store.h"

namespace victorious {

struct HeadingError {
  double error_rad = 0;  ///< yaw of the telemetry less the true one
  int objects = 0;       ///< tracklets that agree on it
};

/// Estimates the errors of the flights, by video id; those without a common error of at least 1.5 degrees have none, nor
/// have errors above 20 degrees, which are those of another flight's telemetry. Ranges are not used, so that a wrong field
/// of view does not matter.
std::map<std::int64_t, HeadingError> EstimateHeadingErrors(std::span<const ObservedTracklet> tracklets);

/// Turns lines of sight and headings of the tracklets back by the errors of their videos.
void TurnBack(const std::map<std::int64_t, HeadingError>& errors, std::span<ObservedTracklet> tracklets);

/// Passes one line for each error to `warn`.
void WarnOfHeadingErrors(const std::map<std::int64_t, HeadingError>& errors, std::span<const VideoRecord> videos,
                         const std::function<void(const std::string&)>& warn);

}  // namespace victorious
