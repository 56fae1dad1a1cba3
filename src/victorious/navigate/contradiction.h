// Which landmarks are not where they are told to be, by contradiction with others: without telemetry a landmark that is
// seen alone for a while is believed there, and only what was before and after it, or beside it, speaks against it.
//
// The flight is estimated from the sightings of each landmark alone. Wherever that is sure enough, it tells how the
// others should have been seen. Of landmarks that contradict each other, the one that contradicts most others, and
// agrees with fewest, is taken to be wrong, until no two contradict each other. Of several alike it is the one without
// which all others make the smoothest flight.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "victorious/navigate/landmark.h"
#include "victorious/navigate/navigate_options.h"
#include "victorious/navigate/smoother.h"

namespace victorious {

/// @param sightings    by frame
/// @param landmark_of  one a sighting: of which landmark it is taken to be
/// @return one a landmark
/// Cost: for each landmark that of smoothing the flight while it is seen, and some seconds before and after, and of
/// looking up all sightings; where several contradict alike, that of smoothing the whole flight without each of them.
std::vector<bool> FindContradictions(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                     std::span<const LandmarkSighting> sightings,
                                     std::span<const std::optional<std::size_t>> landmark_of,
                                     const NavigateOptions& options);

}  // namespace victorious
