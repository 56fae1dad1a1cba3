// Angle conversions. Angles are radians inside the program; degrees occur only at its interfaces (files, flags, pages).
#pragma once

#include <cmath>
#include <numbers>

namespace victorious {

inline constexpr double kPi = std::numbers::pi;

constexpr double DegreesFromRadians(double radians) { return radians * (180.0 / kPi); }
constexpr double RadiansFromDegrees(double degrees) { return degrees * (kPi / 180.0); }

/// The equivalent angle in [-pi, pi].
inline double WrapAngle(double angle_rad) { return std::remainder(angle_rad, 2.0 * kPi); }

}  // namespace victorious
