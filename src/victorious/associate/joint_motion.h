// Private to associate/: an object that moves and is seen by several flights at about the same time, as their UTC says.
//
// There is no joint fit of the lines of sight of several flights: within a flight the path is far more accurate than
// the errors that all its lines share (position, attitude, clock, field of view), which are independent of those of
// other flights. Each flight gives its own path (object_place.h). Two paths are one object's if they agree where the
// flights see it together, within the errors of both, and if they stay at the same distance from each other, within the
// small errors inside a flight. The place is that of the flight that sees the object last, whose common error the other
// flights measure, one Kalman update each:
//
//   d = (place by the other flight) - (place by this flight), at one time; covariance common + other + relative
#pragma once

#include <optional>
#include <span>

#include "victorious/associate/object_place.h"

namespace victorious {

/// What one flight says of an object.
struct ObjectInFlight {
  ObjectPlace relative;     ///< for comparisons within the flight, with its path, if it has one; has a place
  Geolocation absolute;     ///< at the same time, with all errors of the flight
  double utc_offset_s = 0;  ///< UTC minus the video's time, since an epoch that all flights share
  double first_s = 0;       ///< of its sightings, UTC
  double last_s = 0;
  double observations = 0;  ///< number of its bearing observations
};

/// The distance of two hypotheses: Euclidean, and Mahalanobis with the errors of both.
struct HypothesisDistance {
  double metres = 0;
  double sigmas = 0;
};

/// An object that one flight has lost may be seen by another so much later, s: beyond, its path says too little.
inline constexpr double kMaxFlightGap_s = 2;

/// The distance of the paths of two flights: the larger one of that in the middle of the time in which both see the
/// object (or in the middle between, if one ends before the other begins), and of its change over that time.
/// std::nullopt if more than kMaxFlightGap_s are between them.
[[nodiscard]] std::optional<HypothesisDistance> CompareFlights(const ObjectInFlight& a, const ObjectInFlight& b);

/// The estimate by all flights, of the time of the last sighting, on the clock of the video that has it. Without path.
/// @param flights  at least one
[[nodiscard]] ObjectPlace FuseFlights(std::span<const ObjectInFlight> flights);

}  // namespace victorious
