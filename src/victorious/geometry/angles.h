// Angle conversions. Angles are radians inside the program; degrees occur only at its interfaces (files, flags, pages).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace victorious {

inline constexpr double kPi = std::numbers::pi;

constexpr double DegreesFromRadians(double radians) { return radians * (180.0 / kPi); }
constexpr double RadiansFromDegrees(double degrees) { return degrees * (kPi / 180.0); }

/// The equivalent angle in [-pi, pi].
inline double WrapAngle(double angle_rad) {
  return std::abs(angle_rad) <= kPi ? angle_rad : std::remainder(angle_rad, 2.0 * kPi);  // the latter is slow
}

/// The absolute difference of two angles that differ by at most 2 pi, in [0, pi].
inline double AngleBetween(double a_rad, double b_rad) {
  const double difference_rad = std::abs(a_rad - b_rad);
  return std::min(difference_rad, std::abs(2.0 * kPi - difference_rad));
}

}  // namespace victorious
