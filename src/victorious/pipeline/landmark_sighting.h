// From how an object stands before the camera to a sighting of a landmark, with what it is worth.
#pragma once

#include <optional>

#include "victorious/base/options.h"
#include "victorious/navigate/landmark.h"
#include "victorious/pipeline/stance.h"

namespace victorious {

/// Matched points err together, and of few some are matched to a view from elsewhere: what they tell of how the object
/// is turned is never better than these. The errors are turns about the points' middle, so they move the object's.
struct SightingOptions {
  double least_turn_deg = 1;
  double sure_points = 30;

  void ListFields(FieldList& fields);
};

/// @param sight  the errors of points, of the direction and of the range
/// The frame and the model are left to the caller. Nothing where neither points nor a range tell its distance.
std::optional<LandmarkSighting> SightingOf(const Stance& stance, const SightOptions& sight,
                                           const SightingOptions& options);

}  // namespace victorious
