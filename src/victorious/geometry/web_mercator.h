// The world's square of Web Mercator maps: 0 to 1 eastwards from 180 degrees west, and southwards from 85.05 degrees
// north.
#pragma once

#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {

inline double MercatorEast(double longitude_rad) { return longitude_rad / (2 * kPi) + 0.5; }
inline double MercatorSouth(double latitude_rad) { return 0.5 - std::asinh(std::tan(latitude_rad)) / (2 * kPi); }

}  // namespace victorious
