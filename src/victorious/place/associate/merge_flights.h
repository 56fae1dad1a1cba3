// Private to associate/: which objects of several flights are one.
#pragma once

#include <span>
#include <vector>

#include "victorious/place/associate/flight_fusion.h"
#include "victorious/place/associate/flight_registration.h"
#include "victorious/place/associate/link_constraints.h"
#include "victorious/place/associate/object_options.h"

namespace victorious {

/// One object, as each of its flights sees it: at least one, by video.
using ObjectInFlights = std::vector<const ObjectInFlight*>;

/// Merges objects of one model, nearest pair first, until no pair passes the gates (associate_objects.h). The distance
/// of two objects of several flights each is the root mean square over the pairs of flights that can be compared; two
/// objects of one flight are never merged, nor those between which a cannot-link stands. Cost: a comparison for each
/// pair of static objects within reach of each other, and for each pair of one time of which one moves.
/// @param objects  must outlive the result
[[nodiscard]] std::vector<ObjectInFlights> MergeFlights(std::span<const ObjectInFlight* const> objects,
                                                        const FlightRegistrations& registrations,
                                                        const LinkConstraints& constraints,
                                                        const ObjectOptions& options);

}  // namespace victorious
