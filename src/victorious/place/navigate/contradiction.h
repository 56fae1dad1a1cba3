// Detects landmarks whose given place is wrong, by their inconsistency with other landmarks. Only needed without
// telemetry: a wrong landmark that is alone in view for a while is then accepted there, and only sightings of other
// landmarks before, after or at the same time contradict it.
//
// The flight is estimated from the sightings of each landmark alone. Where this estimate is accurate enough, it
// predicts the sightings of the other landmarks. Of the landmarks that contradict each other, the one with the most
// contradictions and the fewest agreements is rejected, until no two contradict each other. Ties are resolved by the
// cost of the smoothed flight: the landmark is rejected without which all others give the smallest cost.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "victorious/place/navigate/landmark.h"
#include "victorious/place/navigate/navigate_options.h"
#include "victorious/place/navigate/smoother.h"

namespace victorious {

/// Finds the wrong landmarks.
/// @param sightings             ordered by frame
/// @param landmark_by_sighting  one per sighting: index of its landmark, or std::nullopt
/// Cost: per landmark, smoothing the flight while it is in view and some seconds before and after, and one pass over
/// all sightings; in the case of a tie, smoothing the whole flight without each of the tied landmarks.
/// @return one per landmark: true if it is wrong
std::vector<bool> FindContradictions(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                                     std::span<const LandmarkSighting> sightings,
                                     std::span<const std::optional<std::size_t>> landmark_by_sighting,
                                     const NavigateOptions& options);

}  // namespace victorious
