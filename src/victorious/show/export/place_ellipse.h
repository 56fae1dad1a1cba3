// The horizontal 90 % confidence ellipse of a place, as drawn on maps.
#pragma once

#include <vector>

#include "victorious/types/geolocation.h"

namespace victorious {

/// Closed: the last point is the first. Longitudes in [-pi, pi].
using GeodeticRing = std::vector<GeodeticPoint>;

/// The border of the ellipse by the horizontal part of the covariance, counter-clockwise, at the height of the place:
/// one ring, or two if the antimeridian cuts it (RFC 7946, section 3.1.9).
std::vector<GeodeticRing> ComputeEllipse(const Geolocation& place);

}  // namespace victorious
