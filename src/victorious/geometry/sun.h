// The sun's position in the sky.
#pragma once

#include <cstdint>

#include "victorious/geometry/geodesy.h"

namespace victorious {

struct Sun {
  double azimuth_rad = 0;    ///< clockwise from north
  double elevation_rad = 0;  ///< above the horizon, without refraction
};

/// The sun's direction at a time and place, by the low-precision formulas of the Astronomical Almanac (Michalsky, Solar
/// Energy 40, 1988): accurate to 0.02 degrees from 1950 to 2050.
/// @param utc_us  microseconds since 1970-01-01 UTC
[[nodiscard]] Sun SunAt(std::int64_t utc_us, const GeodeticPoint& place);

}  // namespace victorious
