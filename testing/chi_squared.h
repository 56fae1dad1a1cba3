// For tests only: quantiles of the chi-square distribution.
#pragma once

namespace victorious::testing {

/// 90 % of the chi-square distribution with 3 degrees of freedom: the squared Mahalanobis radius of the 90 % ellipsoid
/// of a place.
inline constexpr double kChiSquared90Of3 = 6.2513886;

}  // namespace victorious::testing
