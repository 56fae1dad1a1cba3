// Private to kernels/: the polynomial of orientation_ref.cc and orientation_simd.cc.
#pragma once

namespace victorious::kernels {

// atan(t), 0 <= t <= 1, in bins of 10 degrees; M. Abramowitz and I. Stegun, "Handbook of Mathematical Functions", 4.4.
inline constexpr float kBinsPerRadian = 5.7295780F;
inline constexpr float kAtan1 = 0.9992150F * kBinsPerRadian;
inline constexpr float kAtan3 = -0.3211819F * kBinsPerRadian;
inline constexpr float kAtan5 = 0.1462766F * kBinsPerRadian;
inline constexpr float kAtan7 = -0.0389929F * kBinsPerRadian;
inline constexpr float kQuarterTurn = 9;

}  // namespace victorious::kernels
