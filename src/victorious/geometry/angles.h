// Angles are radians inside; degrees stand only at an edge (files, flags, pages).
#pragma once

#include <cmath>
#include <numbers>

namespace victorious {

inline constexpr double kPi = std::numbers::pi;

constexpr double DegreesFromRadians(double radians) { return radians * (180.0 / kPi); }
constexpr double RadiansFromDegrees(double degrees) { return degrees * (kPi / 180.0); }

/// The same direction in [-pi, pi].
inline double WrapAngle(double angle_rad) { return std::remainder(angle_rad, 2.0 * kPi); }

}  // namespace victorious
