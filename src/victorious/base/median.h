// The median of samples, and of the Rayleigh distribution.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "victorious/base/check.h"

namespace victorious {

/// The median of the Rayleigh distribution with sigma 1 (the norm of two standard normal variables): sqrt(2 ln 2).
inline constexpr double kRayleighMedian = 1.1774100225154747;

/// Returns the median of one or more values; for an even number of them the upper of the two middle ones. O(n).
inline double Median(std::vector<double> values) {
  VICTORIOUS_CHECK(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Returns the median, or `of_none` if there are no values.
inline double MedianOr(std::vector<double> values, double of_none) {
  return values.empty() ? of_none : Median(std::move(values));
}

}  // namespace victorious
